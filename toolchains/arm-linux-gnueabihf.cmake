# 32-bit ARM with hardware floating point, ARMv7 and later (Debian armhf).
# Use: tools/sysroot --arch armhf && cmake -G Ninja --toolchain toolchains/arm-linux-gnueabihf.cmake \
#        -DBESS_WORKSTATION=OFF -S . -B build-armhf
set(BESS_TRIPLET arm-linux-gnueabihf)
set(BESS_SYSROOT_NAME armhf)
set(BESS_PROCESSOR arm)
set(BESS_CPU_FLAGS "")
set(BESS_EMULATOR qemu-arm-static)
include(${CMAKE_CURRENT_LIST_DIR}/debian-cross.cmake)
