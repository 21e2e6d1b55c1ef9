# Cross build for 64-bit ARM, Cortex-A53 (Raspberry Pi 3) and later, against the folder of tools/sysroot.
# Use: tools/sysroot && cmake -G Ninja --toolchain toolchains/aarch64-linux-gnu.cmake -DBESS_WORKSTATION=OFF \
#        -S . -B build-aarch64
# Tests run through qemu-user when it is installed (package qemu-user-static).
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(BESS_SYSROOT "${CMAKE_CURRENT_LIST_DIR}/../build-sysroot/arm64" CACHE PATH "Libraries of the target")
get_filename_component(BESS_SYSROOT "${BESS_SYSROOT}" ABSOLUTE)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES BESS_SYSROOT)

set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_SYSROOT "${BESS_SYSROOT}")
set(CMAKE_C_FLAGS_INIT "-mcpu=cortex-a53")
set(CMAKE_CXX_FLAGS_INIT "-mcpu=cortex-a53")
set(libraries "${BESS_SYSROOT}/usr/lib/aarch64-linux-gnu")
set(CMAKE_EXE_LINKER_FLAGS_INIT
    "-Wl,-rpath-link,${libraries} -Wl,-rpath-link,${BESS_SYSROOT}/lib/aarch64-linux-gnu")

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} "${BESS_SYSROOT}")
set(ENV{PKG_CONFIG_LIBDIR} "${libraries}/pkgconfig:${BESS_SYSROOT}/usr/share/pkgconfig")

find_program(BESS_QEMU_USER qemu-aarch64-static)
if(BESS_QEMU_USER)
  set(CMAKE_CROSSCOMPILING_EMULATOR "${BESS_QEMU_USER};-L;${BESS_SYSROOT}")
endif()
