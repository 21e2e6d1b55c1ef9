# Additional files of the Debian package: probation of new versions, rules for users, folders and
# devices, and files of tools/package (man pages, completion, certificate) in BUILD/package/edge.
set(package_dir ${CMAKE_SOURCE_DIR}/edge/delivery/package)
install(PROGRAMS ${package_dir}/bess-probation DESTINATION sbin
        COMPONENT edge_package)
install(FILES ${package_dir}/update.conf DESTINATION /etc/bess
        RENAME update.conf.example
        COMPONENT edge_package)
install(FILES ${CMAKE_SOURCE_DIR}/edge/delivery/systemd/bess-probation.service
        ${CMAKE_SOURCE_DIR}/edge/delivery/systemd/bess-probation.timer
        ${CMAKE_SOURCE_DIR}/edge/delivery/systemd/bess-recover.service
        DESTINATION lib/systemd/system COMPONENT edge_package)
install(FILES ${package_dir}/bess.tmpfiles DESTINATION lib/tmpfiles.d RENAME bess.conf
        COMPONENT edge_package)
install(FILES ${package_dir}/60-bess-rs485.rules DESTINATION lib/udev/rules.d
        COMPONENT edge_package)
install(FILES ${BESS_STUDENT_DIR}/student_weights.h DESTINATION share/bess COMPONENT edge_package)
install(DIRECTORY ${CMAKE_BINARY_DIR}/package/edge/ DESTINATION . COMPONENT edge_package)
