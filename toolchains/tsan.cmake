# Thread sanitizer, for what has threads: edge and simulators.
# Use: cmake -C toolchains/tsan.cmake -S . -B build-tsan
set(CMAKE_C_COMPILER clang CACHE STRING "")
set(CMAKE_CXX_COMPILER clang++ CACHE STRING "")
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1" CACHE STRING "")
set(BESS_NATIVE OFF CACHE BOOL "")
set(BESS_SANITIZE "thread" CACHE STRING "")
