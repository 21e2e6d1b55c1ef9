# 64-bit ARM, Cortex-A53 (Raspberry Pi 3) and later.
# Use: tools/sysroot && cmake -G Ninja --toolchain toolchains/aarch64-linux-gnu.cmake -DBESS_WORKSTATION=OFF \
#        -S . -B build-aarch64
# Tests run through qemu-user when it is installed (tools/setup --cross).
set(BESS_TRIPLET aarch64-linux-gnu)
set(BESS_SYSROOT_NAME arm64)
set(BESS_PROCESSOR aarch64)
set(BESS_CPU_FLAGS "-mcpu=cortex-a53")
set(BESS_EMULATOR qemu-aarch64-static)
include(${CMAKE_CURRENT_LIST_DIR}/debian-cross.cmake)
