# Second compiler and sanitizers for the edge; builds in a minute.
# Use: cmake -C toolchains/clang-asan-edge.cmake -S . -B build-edge-clang
set(BESS_UNITY ON CACHE BOOL "")
include(${CMAKE_CURRENT_LIST_DIR}/clang.cmake)
set(BESS_SANITIZE "address,undefined" CACHE STRING "")
set(BESS_WORKSTATION OFF CACHE BOOL "")
set(CMAKE_CXX_FLAGS_DEBUG "-g1" CACHE STRING "") # lines in reports
