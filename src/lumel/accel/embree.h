// The queries of Embree, alike in versions 3 and 4. Only this room includes it.
#pragma once

#ifdef LUMEL_EMBREE4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace lumel::embree {

#ifdef LUMEL_EMBREE4

inline RTCIntersectArguments arguments(bool coherent) {
    RTCIntersectArguments made;
    rtcInitIntersectArguments(&made);
    made.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    return made;
}
inline void intersect(RTCScene scene, RTCRayHit& query) { rtcIntersect1(scene, &query); }
inline void intersect(const int* valid, RTCScene scene, bool coherent, RTCRayHit8& query) {
    RTCIntersectArguments a = arguments(coherent);
    rtcIntersect8(valid, scene, &query, &a);
}
inline void intersect(const int* valid, RTCScene scene, bool coherent, RTCRayHit16& query) {
    RTCIntersectArguments a = arguments(coherent);
    rtcIntersect16(valid, scene, &query, &a);
}
inline void occluded(RTCScene scene, RTCRay& query) { rtcOccluded1(scene, &query); }
inline void occluded(const int* valid, RTCScene scene, RTCRay8& query) { rtcOccluded8(valid, scene, &query); }

#else

inline RTCIntersectContext context(bool coherent = false) {
    RTCIntersectContext made;
    rtcInitIntersectContext(&made);
    made.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return made;
}
inline void intersect(RTCScene scene, RTCRayHit& query) {
    RTCIntersectContext c = context();
    rtcIntersect1(scene, &c, &query);
}
inline void intersect(const int* valid, RTCScene scene, bool coherent, RTCRayHit8& query) {
    RTCIntersectContext c = context(coherent);
    rtcIntersect8(valid, scene, &c, &query);
}
inline void intersect(const int* valid, RTCScene scene, bool coherent, RTCRayHit16& query) {
    RTCIntersectContext c = context(coherent);
    rtcIntersect16(valid, scene, &c, &query);
}
inline void occluded(RTCScene scene, RTCRay& query) {
    RTCIntersectContext c = context();
    rtcOccluded1(scene, &c, &query);
}
inline void occluded(const int* valid, RTCScene scene, RTCRay8& query) {
    RTCIntersectContext c = context();
    rtcOccluded8(valid, scene, &c, &query);
}

#endif

}  // namespace lumel::embree
