# libFuzzer with address and undefined-behaviour sanitizers, for tests/checks/fuzz. Use: tools/fuzz
set(CMAKE_C_COMPILER clang CACHE STRING "")
set(CMAKE_CXX_COMPILER clang++ CACHE STRING "")
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1" CACHE STRING "")
set(BESS_NATIVE OFF CACHE BOOL "")
set(BESS_SANITIZE "address,undefined" CACHE STRING "")
set(BESS_FUZZ ON CACHE BOOL "")
