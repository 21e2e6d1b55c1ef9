# The page of a report: its style sheets, its scripts and the chart library, embedded into
# bess-train.
find_package(ZLIB REQUIRED)
find_file(BESS_CHART_JS chart.min.js PATHS /usr/share/javascript/chart.js NO_DEFAULT_PATH
          DOC "Chart.js 3.9, minified, of Debian's libjs-chart.js")
if(NOT BESS_CHART_JS)
  message(FATAL_ERROR "chart.min.js is not there, which the report's page is drawn with: run "
                      "tools/setup (Debian's libjs-chart.js), or name the file with "
                      "-DBESS_CHART_JS=FILE")
endif()
file(READ "${BESS_CHART_JS}" chart_js_head LIMIT 40)
if(NOT chart_js_head MATCHES "Chart\\.js v3\\.9\\.")
  message(FATAL_ERROR "${BESS_CHART_JS}: is not Chart.js 3.9, which the report's page is written "
                      "for: name that of Debian 12's libjs-chart.js with -DBESS_CHART_JS=FILE")
endif()

file(GLOB page_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*.js
     ${CMAKE_CURRENT_LIST_DIR}/*.css
     ${CMAKE_CURRENT_LIST_DIR}/*.html)
# Of the answers of --json: 'bess-train schema' prints it, and the package installs it.
list(APPEND page_files ${BESS_CHART_JS} ${CMAKE_CURRENT_LIST_DIR}/answers.schema.json)
bess_embed(figures workstation/report/figures/page_files.h ${page_files})
