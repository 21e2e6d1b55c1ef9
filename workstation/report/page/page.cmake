# Files of the report page, with the chart library, embedded into bess-train.
find_package(ZLIB REQUIRED)
include(${CMAKE_SOURCE_DIR}/shared/host/embed/pages.cmake)

file(GLOB page_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*.js
     ${CMAKE_CURRENT_LIST_DIR}/*.css
     ${CMAKE_CURRENT_LIST_DIR}/*.html)
# Of the answers of --json: 'bess-train schema' prints it, and the package installs it.
list(APPEND page_files ${BESS_PAGE_FILES}
     ${CMAKE_CURRENT_LIST_DIR}/answers.schema.json)
bess_embed(figures workstation/report/figures/html.h ${page_files})
