# Debian packages by CPack, made with tools/package, which sets:
#   BESS_PACKAGE_VERSION     0.1.0+20261122131500.g234f6f8
#   BESS_EDGE_DEPENDS, BESS_WORKSTATION_DEPENDS    computed from the linked libraries
include(${CMAKE_SOURCE_DIR}/edge/delivery/package/install.cmake)
if(TARGET bess-train)
  install(TARGETS bess-train bess-sim DESTINATION bin COMPONENT workstation)
  # Separate copies, because bess-edge may or may not be installed on a workstation.
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/edge/device/maps ${CMAKE_SOURCE_DIR}/edge/device/meters
          DESTINATION share/bess-workstation
          COMPONENT workstation FILES_MATCHING PATTERN *.toml)
  install(FILES ${CMAKE_SOURCE_DIR}/workstation/report/page/answers.schema.json
          DESTINATION share/bess-workstation
          COMPONENT workstation)
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/shared/manual DESTINATION share/doc/bess-workstation
          COMPONENT workstation PATTERN notebook EXCLUDE)
  install(DIRECTORY ${CMAKE_BINARY_DIR}/package/workstation/ DESTINATION . COMPONENT workstation)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME bess)
set(CPACK_PACKAGE_CONTACT "the committer")  # set by tools/package
set(CPACK_PACKAGE_VENDOR bess)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE
    GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_PACKAGE_HOMEPAGE "")
set(CPACK_DEBIAN_PACKAGE_SECTION misc)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
# The running version is a copy of the delivered files: edge/delivery/package.
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_SOURCE_DIR}/tools/delivery/packaging/arrange_delivery.cmake)
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_SOURCE_DIR}/tools/delivery/packaging/cpack_project.cmake)

set(CPACK_DEBIAN_BESS-EDGE_PACKAGE_NAME bess-edge)
set(CPACK_DEBIAN_BESS-EDGE_DESCRIPTION "battery controller on the imbalance price
Charges when the imbalance price is low and discharges when it is high, every
two minutes, over Modbus, with a fixed-point policy that was proved over every
input. Includes the notifier bess-notify, register maps, and supervised
upgrades: a version that fails its probation is rolled back.")
set(package_dir ${CMAKE_SOURCE_DIR}/edge/delivery/package)
set(CPACK_DEBIAN_BESS-EDGE_PACKAGE_CONTROL_EXTRA
    "${package_dir}/preinst;${package_dir}/postinst;${package_dir}/prerm;${package_dir}/postrm;${package_dir}/conffiles")
set(CPACK_DEBIAN_BESS-EDGE_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
set(CPACK_DEBIAN_BESS-WORKSTATION_PACKAGE_NAME bess-workstation)
set(CPACK_DEBIAN_BESS-WORKSTATION_DESCRIPTION "trains, corrects and proves the policy of bess-edge
Learns a policy from imbalance prices, corrects it, proves it over every input
and exports it as a C array (bess-train); simulates battery and market for
tests on one machine (bess-sim).")

include(CPack)
cpack_add_component_group(bess-edge)
cpack_add_component_group(bess-workstation)
cpack_add_component(edge GROUP bess-edge)
cpack_add_component(edge_package GROUP bess-edge)
if(TARGET bess-train)
  cpack_add_component(workstation GROUP bess-workstation)
endif()
