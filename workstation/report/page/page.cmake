# The page of a report: its style sheets, its scripts and the chart library, embedded into
# bess-train.
find_package(ZLIB REQUIRED)
find_file(BESS_CHART_JS chart.min.js PATHS /usr/share/javascript/chart.js NO_DEFAULT_PATH
          DOC "Chart.js 3.9, minified, of Debian's libjs-chart.js")
if(NOT BESS_CHART_JS)
  message(FATAL_ERROR "chart.min.js is not there, which the report's page is drawn with: run tools/setup "
                      "(Debian's libjs-chart.js), or name the file with -DBESS_CHART_JS=FILE")
endif()
file(READ "${BESS_CHART_JS}" chart_js_head LIMIT 40)
if(NOT chart_js_head MATCHES "Chart\\.js v3\\.9\\.")
  message(FATAL_ERROR "${BESS_CHART_JS}: is not Chart.js 3.9, which the report's page is written for: name "
                      "that of Debian 12's libjs-chart.js with -DBESS_CHART_JS=FILE")
endif()

file(GLOB page_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*.js ${CMAKE_CURRENT_LIST_DIR}/*.css
     ${CMAKE_CURRENT_LIST_DIR}/*.html)
# Of the answers of --json: 'bess-train schema' prints it, and the package installs it.
list(APPEND page_files ${BESS_CHART_JS} ${CMAKE_CURRENT_LIST_DIR}/../answers.schema.json)
list(JOIN page_files "|" page_files_in_one)
set(page_source ${CMAKE_CURRENT_BINARY_DIR}/page_files.cpp)
add_custom_command(
  OUTPUT ${page_source}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${page_source} -DHEADER=workstation/report/page_files.h
          "-DFILES=${page_files_in_one}" -P ${CMAKE_SOURCE_DIR}/shared/host/embed.cmake
  DEPENDS ${page_files} ${CMAKE_SOURCE_DIR}/shared/host/embed.cmake
  COMMENT "Embedding the report's page" VERBATIM)
target_sources(report PRIVATE ${page_source})
set_source_files_properties(${page_source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON
                            SKIP_PRECOMPILE_HEADERS ON COMPILE_OPTIONS -Wno-overlength-strings)
