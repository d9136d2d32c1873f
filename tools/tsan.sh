#!/usr/bin/env bash
# Run the C++ tests under the thread sanitizer: tools/tsan.sh
#
# The sanitizer sees only what it has compiled, and a oneTBB that it has not would look like one long race. So oneTBB's source is
# fetched from the distribution (no root needed) and built once, with the sanitizer, under build/.
set -euo pipefail
cd "$(dirname "$0")/.."
tbb=$PWD/build/tsan-tbb

# Fetch the source package onetbb into the current folder, from the archives that apt knows, in a state of its own.
fetch_tbb() {
    mkdir -p state/partial cache
    # shellcheck disable=SC2016  # these are apt's variables
    apt-get indextargets --format 'deb-src $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
        grep -E '/(debian|ubuntu)' | sort -u >sources.list
    local own=(-o Dir::Etc::sourcelist="$PWD/sources.list" -o Dir::Etc::sourceparts=/dev/null -o Dir::State::lists="$PWD/state" -o Dir::Cache="$PWD/cache")
    apt-get "${own[@]}" update -qq
    apt-get "${own[@]}" source -qq --download-only onetbb
    tar -xf onetbb_*.orig.tar.*
}

if [[ ! -e $tbb/installed/done ]]; then
    rm -rf "$tbb"
    mkdir -p "$tbb"
    (cd "$tbb" && fetch_tbb)
    cmake -S "$tbb"/*TBB-* -B "$tbb/build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBB_SANITIZE=thread \
        -DTBBMALLOC_BUILD=OFF -DTBBMALLOC_PROXY_BUILD=OFF -DTBB_DISABLE_HWLOC_AUTOMATIC_SEARCH=ON -DCMAKE_INSTALL_PREFIX="$tbb/installed"
    cmake --build "$tbb/build"
    cmake --install "$tbb/build" >/dev/null
    touch "$tbb/installed/done"
fi

cmake --preset tsan -DTBB_DIR="$(dirname "$(find "$tbb/installed" -name TBBConfig.cmake)")"
cmake --build --preset tsan
ctest --preset tsan
