# Cross build against a folder of tools/sysroot; included by the toolchain files, which say for what:
#   BESS_TRIPLET     aarch64-linux-gnu      BESS_SYSROOT_NAME  arm64
#   BESS_PROCESSOR   aarch64                BESS_CPU_FLAGS     -mcpu=cortex-a53     BESS_EMULATOR  qemu-aarch64-static
set(BESS_SYSROOT "${CMAKE_CURRENT_LIST_DIR}/../build-sysroot/${BESS_SYSROOT_NAME}" CACHE PATH
    "Libraries of the target")
get_filename_component(BESS_SYSROOT "${BESS_SYSROOT}" ABSOLUTE)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES BESS_SYSROOT)

set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR ${BESS_PROCESSOR})
set(CMAKE_C_COMPILER ${BESS_TRIPLET}-gcc)
set(CMAKE_CXX_COMPILER ${BESS_TRIPLET}-g++)
set(CMAKE_SYSROOT "${BESS_SYSROOT}")
set(CMAKE_C_FLAGS_INIT "${BESS_CPU_FLAGS}")
set(CMAKE_CXX_FLAGS_INIT "${BESS_CPU_FLAGS}")
set(libraries "${BESS_SYSROOT}/usr/lib/${BESS_TRIPLET}")
set(CMAKE_EXE_LINKER_FLAGS_INIT
    "-Wl,-rpath-link,${libraries} -Wl,-rpath-link,${BESS_SYSROOT}/lib/${BESS_TRIPLET}")

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} "${BESS_SYSROOT}")
set(ENV{PKG_CONFIG_LIBDIR} "${libraries}/pkgconfig:${BESS_SYSROOT}/usr/share/pkgconfig")

find_program(BESS_QEMU_USER ${BESS_EMULATOR})
if(BESS_QEMU_USER)
  set(CMAKE_CROSSCOMPILING_EMULATOR "${BESS_QEMU_USER};-L;${BESS_SYSROOT}")
endif()
