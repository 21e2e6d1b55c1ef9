# Second compiler, same warnings as errors.
# Use: cmake -C toolchains/clang.cmake -S . -B build-clang
set(CMAKE_C_COMPILER clang CACHE STRING "")
set(CMAKE_CXX_COMPILER clang++ CACHE STRING "")
set(CMAKE_BUILD_TYPE Debug CACHE STRING "") # quick to build; only warnings matter
set(BESS_NATIVE OFF CACHE BOOL "")
set(BESS_UNITY OFF CACHE BOOL "") # detects missing includes
