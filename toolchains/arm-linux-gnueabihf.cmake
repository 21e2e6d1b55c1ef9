# Raspberry Pi 2 to 5 with a 32-bit system. After tools/setup --cross and tools/sysroot --arch
# armhf:
#   cmake -G Ninja --toolchain toolchains/arm-linux-gnueabihf.cmake -S . -B build-armhf
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(BESS_TRIPLE arm-linux-gnueabihf)
set(BESS_DEBIAN_ARCH armhf)
set(BESS_QEMU qemu-arm-static)
# Processor: default of Debian's compiler, ARMv7-A with VFPv3-D16. 64-bit times and file positions.
set(BESS_TARGET_FLAGS "-D_FILE_OFFSET_BITS=64 -D_TIME_BITS=64")
include(${CMAKE_CURRENT_LIST_DIR}/debian-cross.cmake)
# Programs with cpp-httplib: its times have 32 bits in Debian 12 and 64 bits in Debian 13, whose
# libraries have the suffix t64.
if(EXISTS "${CMAKE_SYSROOT}/usr/share/doc/libcurl4t64")
  set(BESS_PAGE ON CACHE BOOL "")
  set(BESS_SIMULATORS ON CACHE BOOL "")
endif()
