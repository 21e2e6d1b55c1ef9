# Raspberry Pi 2 to 5 with a 32-bit system. After tools/setup --cross and tools/sysroot --arch armhf:
#   cmake -G Ninja --toolchain toolchains/arm-linux-gnueabihf.cmake -S . -B build-armhf
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(BESS_TRIPLE arm-linux-gnueabihf)
set(BESS_DEBIAN_ARCH armhf)
set(BESS_QEMU qemu-arm-static)
set(BESS_CPU_FLAGS "") # what Debian's compiler takes: ARMv7-A with VFPv3-D16
include(${CMAKE_CURRENT_LIST_DIR}/debian-cross.cmake)
