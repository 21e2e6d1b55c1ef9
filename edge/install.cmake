# Installation of component edge: programs, maps, units, user, example configuration. Configuration
# and units contain the paths of the installation.
include(GNUInstallDirs)

# install_with_paths(FILE FOLDER NAME FROM TO...): installs FILE as NAME with each FROM replaced by
# TO; each FROM must occur.
function(install_with_paths file folder name)
  file(READ ${file} text)
  set(pairs ${ARGN})
  while(pairs)
    list(POP_FRONT pairs from to)
    string(FIND "${text}" "${from}" place)
    if(place EQUAL -1)
      message(FATAL_ERROR "${file}: \"${from}\" not found: correct edge/install.cmake")
    endif()
    string(REPLACE "${from}" "${to}" text "${text}")
  endwhile()
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/installed/${name} "${text}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/installed/${name} DESTINATION ${folder} COMPONENT edge)
endfunction()

install(TARGETS bess-edge bess-prices DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT edge)
install(DIRECTORY device/maps device/meters DESTINATION ${CMAKE_INSTALL_DATADIR}/bess COMPONENT edge
        FILES_MATCHING PATTERN "*.toml")
install(FILES delivery/systemd/bess-edge-serial.conf delivery/systemd/bess-notify-mailer.conf
        delivery/systemd/bess-notify-orders.conf DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT edge)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/shared/manual DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT edge PATTERN notebook EXCLUDE)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/tools/delivery/monitoring DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT edge)
install(FILES delivery/systemd/bess.sysusers DESTINATION lib/sysusers.d RENAME bess.conf
        COMPONENT edge)
# Absolute, because bess-edge reads /etc for any prefix. An example, so no edited file is replaced.
install_with_paths(${CMAKE_CURRENT_SOURCE_DIR}/bess-edge.toml /etc/bess edge.toml.example
  "map = \"device/maps/" "map = \"${CMAKE_INSTALL_FULL_DATADIR}/bess/maps/"
  "map = \"device/meters/" "map = \"${CMAKE_INSTALL_FULL_DATADIR}/bess/meters/"
  "folder = \"state\"  " "folder = \"/var/lib/bess\"  "
  "#run_folder = \"run\"   " "run_folder = \"/run/bess\""
  "folder = \"notify\"  " "folder = \"/var/lib/bess-notify\"  ")
install_with_paths(${CMAKE_CURRENT_SOURCE_DIR}/delivery/systemd/bess-edge.service lib/systemd/system
  bess-edge.service
  "/usr/bin/bess-edge" "${CMAKE_INSTALL_FULL_BINDIR}/bess-edge"
  "/usr/share/doc/bess" "${CMAKE_INSTALL_FULL_DOCDIR}")
install_with_paths(${CMAKE_CURRENT_SOURCE_DIR}/delivery/systemd/bess-prices.service
  lib/systemd/system bess-prices.service
  "/usr/bin/bess-prices" "${CMAKE_INSTALL_FULL_BINDIR}/bess-prices"
  "/usr/share/doc/bess" "${CMAKE_INSTALL_FULL_DOCDIR}")
if(BESS_NOTIFY)
  install(TARGETS bess-notify DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT edge)
  install_with_paths(${CMAKE_CURRENT_SOURCE_DIR}/delivery/systemd/bess-notify.service
    lib/systemd/system bess-notify.service
    "/usr/bin/bess-notify" "${CMAKE_INSTALL_FULL_BINDIR}/bess-notify"
    "/usr/share/doc/bess" "${CMAKE_INSTALL_FULL_DOCDIR}")
endif()
if(BESS_PAGE)
  install(TARGETS bess-page DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT edge)
  install_with_paths(${CMAKE_CURRENT_SOURCE_DIR}/delivery/systemd/bess-page.service
    lib/systemd/system bess-page.service
    "/usr/bin/bess-page" "${CMAKE_INSTALL_FULL_BINDIR}/bess-page"
    "/usr/share/doc/bess" "${CMAKE_INSTALL_FULL_DOCDIR}")
endif()
