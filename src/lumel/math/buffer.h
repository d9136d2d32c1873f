// Memory for large arrays that are written anew again and again.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>

namespace lumel {

/// Room for many T, without values: it is not cleared, and it stays when less is asked for. Pages that nothing is written to cost nothing.
template <class T>
class Buffer {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

public:
    Buffer() = default;
    Buffer(Buffer&& other) noexcept : data_(std::exchange(other.data_, nullptr)), room_(std::exchange(other.room_, 0)) {}
    Buffer& operator=(Buffer&& other) noexcept {
        std::swap(data_, other.data_), std::swap(room_, other.room_);
        return *this;
    }
    ~Buffer() { release(); }

    /// Make room for `n`; what was there is lost where that is more than before.
    void reserve(size_t n) {
        if (n <= room_) return;
        release();
        data_ = static_cast<T*>(::operator new(n * sizeof(T), kAlignment));
        room_ = n;
    }
    T* data() { return data_; }
    const T* data() const { return data_; }
    T& operator[](size_t i) { return data_[i]; }
    const T& operator[](size_t i) const { return data_[i]; }

private:
    static constexpr std::align_val_t kAlignment{64};
    void release() {
        if (data_) ::operator delete(data_, kAlignment);
        data_ = nullptr, room_ = 0;
    }

    T* data_ = nullptr;
    size_t room_ = 0;
};

}  // namespace lumel
