# Portable release for edge and tools: no instruction beyond the platform's baseline.
# Use: cmake -C toolchains/portable.cmake -S . -B build-portable
set(CMAKE_BUILD_TYPE Release CACHE STRING "")
set(BESS_NATIVE OFF CACHE BOOL "")
