# Raspberry Pi 3, 4, 5 and Zero 2 with a 64-bit system. After tools/setup --cross and tools/sysroot:
#   cmake -G Ninja --toolchain toolchains/aarch64-linux-gnu.cmake -S . -B build-aarch64
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(BESS_TRIPLE aarch64-linux-gnu)
set(BESS_DEBIAN_ARCH arm64)
set(BESS_QEMU qemu-aarch64-static)
set(BESS_CPU_FLAGS "-mcpu=cortex-a53")
include(${CMAKE_CURRENT_LIST_DIR}/debian-cross.cmake)
