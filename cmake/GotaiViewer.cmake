# Builds viewer/ into one HTML page and turns it into a C++ source.
find_program(GOTAI_NODE NAMES node nodejs)
find_program(GOTAI_NPM NAMES npm)
if(GOTAI_NODE AND GOTAI_NPM)
  set(GOTAI_HAVE_NODE ON)
else()
  set(GOTAI_HAVE_NODE OFF)
endif()
option(GOTAI_BUILD_VIEWER "Build the web viewer into the program (needs node and npm)" ${GOTAI_HAVE_NODE})

# gotai_viewer_source(variable): sets the variable to a source that defines view::page_template().
function(gotai_viewer_source variable)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/page_template.cpp)
  set(embed ${CMAKE_COMMAND} -DOUTPUT=${source})
  if(NOT GOTAI_BUILD_VIEWER)
    message(STATUS "Viewer: not built (node and npm not found, or GOTAI_BUILD_VIEWER is off); "
      "`gotai view` and `gotai run --live` will say so")
    add_custom_command(OUTPUT ${source} COMMAND ${embed} -P ${PROJECT_SOURCE_DIR}/cmake/EmbedPage.cmake
      DEPENDS ${PROJECT_SOURCE_DIR}/cmake/EmbedPage.cmake VERBATIM)
    set(${variable} ${source} PARENT_SCOPE)
    return()
  endif()
  if(NOT GOTAI_HAVE_NODE)
    message(FATAL_ERROR "GOTAI_BUILD_VIEWER is on, but node or npm was not found. Install nodejs and npm, "
      "or configure with -DGOTAI_BUILD_VIEWER=OFF.")
  endif()

  # Built in a copy, so that the source folder stays as it is.
  set(from ${PROJECT_SOURCE_DIR}/viewer)
  set(to ${PROJECT_BINARY_DIR}/viewer)
  set(page ${to}/dist/index.html)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${from}/src/*.ts ${from}/src/*.css ${from}/tests/*.ts ${from}/tests/*.mjs)
  list(APPEND files ${from}/index.html ${from}/vite.config.ts ${from}/tsconfig.json)
  add_custom_command(OUTPUT ${to}/installed
    COMMAND ${CMAKE_COMMAND} -E copy ${from}/package.json ${from}/package-lock.json ${to}/
    COMMAND ${CMAKE_COMMAND} -E chdir ${to} ${GOTAI_NPM} ci --prefer-offline --no-audit --no-fund --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${to}/installed
    DEPENDS ${from}/package.json ${from}/package-lock.json
    COMMENT "Viewer: npm ci (without a network, configure with -DGOTAI_BUILD_VIEWER=OFF)" VERBATIM)
  add_custom_command(OUTPUT ${page}
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${to}/src ${to}/tests
    COMMAND ${CMAKE_COMMAND} -E copy_directory ${from}/src ${to}/src
    COMMAND ${CMAKE_COMMAND} -E copy_directory ${from}/tests ${to}/tests
    COMMAND ${CMAKE_COMMAND} -E copy ${from}/index.html ${from}/vite.config.ts ${from}/tsconfig.json ${to}/
    COMMAND ${CMAKE_COMMAND} -E chdir ${to} ${GOTAI_NPM} run --silent build -- --logLevel warn
    DEPENDS ${files} ${to}/installed COMMENT "Viewer: building the page" VERBATIM)
  add_custom_command(OUTPUT ${source}
    COMMAND ${embed} -DINPUT=${page} -P ${PROJECT_SOURCE_DIR}/cmake/EmbedPage.cmake
    DEPENDS ${page} ${PROJECT_SOURCE_DIR}/cmake/EmbedPage.cmake VERBATIM)
  set(${variable} ${source} PARENT_SCOPE)
endfunction()
