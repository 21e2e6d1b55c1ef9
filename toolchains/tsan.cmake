# Thread sanitizer for programs with threads: edge and simulators. Tests of the release start them:
#   cmake -C toolchains/tsan.cmake -S . -B build-tsan && cmake --build build-tsan
#   BESS_EDGE_UNDER_TEST=$PWD/build-tsan/bess-edge BESS_SIM_UNDER_TEST=$PWD/build-tsan/bess-sim \
#     build/processes_test
set(CMAKE_C_COMPILER clang CACHE STRING "")
set(CMAKE_CXX_COMPILER clang++ CACHE STRING "")
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1" CACHE STRING "")
set(BESS_NATIVE OFF CACHE BOOL "")
set(BESS_SANITIZE "thread" CACHE STRING "")
set(BESS_WORKSTATION OFF CACHE BOOL "")
set(BESS_SIMULATORS ON CACHE BOOL "")
set(BESS_TESTS OFF CACHE BOOL "")
