# Package layout, run by cpack before packing: the files of a version go to /usr/lib/bess-edge, for
# delivery only; /usr/bin links to the version that runs.
file(GLOB_RECURSE programs ${CPACK_TEMPORARY_DIRECTORY}/*/usr/bin/bess-edge)
foreach(program ${programs})
  string(REGEX REPLACE "/bin/bess-edge$" "" usr ${program})
  set(delivery ${usr}/lib/bess-edge)
  file(REMOVE_RECURSE ${delivery})
  file(MAKE_DIRECTORY ${delivery}/bin ${delivery}/systemd)
  foreach(name bess-edge bess-prices bess-notify bess-page)
    if(EXISTS ${usr}/bin/${name})
      file(RENAME ${usr}/bin/${name} ${delivery}/bin/${name})
      file(CREATE_LINK /var/lib/bess-edge/current/bin/${name} ${usr}/bin/${name} SYMBOLIC)
    endif()
  endforeach()
  file(RENAME ${usr}/share/bess ${delivery}/share)
  file(COPY ${usr}/lib/systemd/system/bess-edge.service DESTINATION ${delivery}/systemd)
  execute_process(COMMAND sh -c
                  "find bin share systemd -type f | LC_ALL=C sort | xargs sha256sum >SUMS"
                  WORKING_DIRECTORY ${delivery} COMMAND_ERROR_IS_FATAL ANY)
  file(CHMOD ${delivery}/SUMS PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
endforeach()
