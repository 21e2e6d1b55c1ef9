# HEADER with the commit of the working folder, written only on a change: GIVEN if not empty, else
# from git, else "unknown". The suffix "-dirty" marks changed files.
set(commit "${GIVEN}")
if(commit STREQUAL "")
  execute_process(COMMAND git describe --always --dirty --abbrev=12 --exclude=*
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT commit MATCHES "^[-0-9A-Za-z._+]+$")
  set(commit unknown)
endif()
set(text "#define BESS_COMMIT \"${commit}\"\n")
set(before "")
if(EXISTS "${HEADER}")
  file(READ "${HEADER}" before)
endif()
if(NOT before STREQUAL text)
  file(WRITE "${HEADER}" "${text}")
endif()
