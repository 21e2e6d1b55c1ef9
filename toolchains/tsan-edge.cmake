# ThreadSanitizer for the edge's threads. Use: cmake -C toolchains/tsan-edge.cmake -S . -B build-tsan
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(BESS_NATIVE OFF CACHE BOOL "")
set(BESS_SANITIZE "thread" CACHE STRING "")
set(BESS_WORKSTATION OFF CACHE BOOL "")
