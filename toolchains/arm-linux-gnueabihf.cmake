# Raspberry Pi 2 to 5 with a 32-bit system. After tools/setup --cross and tools/sysroot --arch
# armhf:
#   cmake -G Ninja --toolchain toolchains/arm-linux-gnueabihf.cmake -S . -B build-armhf
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(BESS_TRIPLE arm-linux-gnueabihf)
set(BESS_DEBIAN_ARCH armhf)
set(BESS_QEMU qemu-arm-static)
# Processor: what Debian's compiler takes, ARMv7-A with VFPv3-D16. Times and file positions of 64
# bits.
set(BESS_TARGET_FLAGS "-D_FILE_OFFSET_BITS=64 -D_TIME_BITS=64")
include(${CMAKE_CURRENT_LIST_DIR}/debian-cross.cmake)
# What stands on cpp-httplib: its times have 32 bits in Debian 12, 64 in 13, where libraries that
# hand out times are called t64.
if(EXISTS "${CMAKE_SYSROOT}/usr/share/doc/libcurl4t64")
  set(BESS_PAGE ON CACHE BOOL "")
  set(BESS_SIMULATORS ON CACHE BOOL "")
endif()
