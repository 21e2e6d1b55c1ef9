# Common part of the two Raspberry Pi toolchains, which include it and set
#   BESS_TRIPLE          prefix of compiler and library folders, e.g. aarch64-linux-gnu
#   BESS_DEBIAN_ARCH     architecture of the sysroot (tools/sysroot), e.g. arm64
#   BESS_QEMU            emulator for the tests
#   BESS_TARGET_FLAGS    compiler flags, mainly the oldest supported processor
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_C_COMPILER ${BESS_TRIPLE}-gcc)
set(CMAKE_CXX_COMPILER ${BESS_TRIPLE}-g++)
set(CMAKE_C_FLAGS_INIT "${BESS_TARGET_FLAGS}")
set(CMAKE_CXX_FLAGS_INIT "${BESS_TARGET_FLAGS}")

set(BESS_SYSROOT "${CMAKE_CURRENT_LIST_DIR}/../build-sysroot-${BESS_DEBIAN_ARCH}" CACHE PATH
    "Made by tools/sysroot")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES BESS_SYSROOT)
cmake_path(ABSOLUTE_PATH BESS_SYSROOT NORMALIZE OUTPUT_VARIABLE CMAKE_SYSROOT)
if(NOT EXISTS "${CMAKE_SYSROOT}/MANIFEST")
  message(FATAL_ERROR "${CMAKE_SYSROOT}: no sysroot; "
                      "make it with: tools/sysroot --arch ${BESS_DEBIAN_ARCH}")
endif()
find_program(BESS_CROSS_COMPILER ${BESS_TRIPLE}-g++)
if(NOT BESS_CROSS_COMPILER)
  message(FATAL_ERROR "${BESS_TRIPLE}-g++ is not installed; tools/setup --cross installs it")
endif()

# Headers, libraries and packages only from the sysroot, programs only from this machine.
set(CMAKE_FIND_ROOT_PATH ${CMAKE_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR}
    ${CMAKE_SYSROOT}/usr/lib/${BESS_TRIPLE}/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)
# Indirect libraries, which the linker needs to resolve symbols.
set(CMAKE_EXE_LINKER_FLAGS_INIT
    "-Wl,-rpath-link,${CMAKE_SYSROOT}/lib/${BESS_TRIPLE}:${CMAKE_SYSROOT}/usr/lib/${BESS_TRIPLE}")

# ctest runs the tests in the emulator, if installed.
find_program(BESS_EMULATOR ${BESS_QEMU})
if(BESS_EMULATOR)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${BESS_EMULATOR} -L ${CMAKE_SYSROOT})
else()
  set(BESS_TESTS OFF CACHE BOOL "")
endif()

set(BESS_WORKSTATION OFF CACHE BOOL "")
