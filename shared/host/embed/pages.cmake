# BESS_PAGE_FILES: chart library, its use and base style sheet, embedded in every page.
find_file(BESS_CHART_JS chart.min.js PATHS /usr/share/javascript/chart.js NO_DEFAULT_PATH
          NO_CMAKE_FIND_ROOT_PATH  # a sysroot has no scripts
          DOC "Chart.js 3.9, minified, of Debian's libjs-chart.js")
if(NOT BESS_CHART_JS)
  message(FATAL_ERROR "chart.min.js is missing, which the pages need: run tools/setup "
                      "(Debian's libjs-chart.js), or set -DBESS_CHART_JS=FILE")
endif()
file(READ "${BESS_CHART_JS}" chart_js_head LIMIT 40)
if(NOT chart_js_head MATCHES "Chart\\.js v3\\.9\\.")
  message(FATAL_ERROR "${BESS_CHART_JS}: is not Chart.js 3.9, which the pages need: "
                      "use that of Debian 12's libjs-chart.js with -DBESS_CHART_JS=FILE")
endif()
set(BESS_PAGE_FILES ${BESS_CHART_JS} ${CMAKE_SOURCE_DIR}/shared/host/embed/charts.js
    ${CMAKE_SOURCE_DIR}/shared/host/embed/document.css)
