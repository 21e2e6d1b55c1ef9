# Address and undefined-behaviour sanitizers. Use: cmake -C toolchains/asan.cmake -S . -B build-asan
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(BESS_NATIVE OFF CACHE BOOL "")
set(BESS_SANITIZE "address,undefined" CACHE STRING "")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1" CACHE STRING "") # quick to build, lines in reports
