# Workstation release: native vector instructions (the gradient step is 2.7 times slower without).
# Use: cmake -C toolchains/release.cmake -S . -B build
set(CMAKE_BUILD_TYPE Release CACHE STRING "")
set(BESS_NATIVE ON CACHE BOOL "")
