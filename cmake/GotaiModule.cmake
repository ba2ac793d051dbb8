# One folder = one module = one target. The linker enforces the arrows of docs/architecture.md:
# a module can only use what it names in DEPENDS.

add_library(gotai_options INTERFACE)
target_compile_options(gotai_options INTERFACE
  $<BUILD_INTERFACE:-Wall;-Wextra;-Wconversion;-Wshadow>
  # GCC 12 warns of std::string's own code (GCC bug 105329).
  $<$<CXX_COMPILER_ID:GNU>:$<BUILD_INTERFACE:-Wno-restrict>>
  # In large units GCC takes the local types of a source for those of a header.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${CMAKE_UNITY_BUILD}>>:$<BUILD_INTERFACE:-Wno-subobject-linkage>>
  $<BUILD_INTERFACE:-ffp-contract=off>
  $<$<BOOL:${GOTAI_WARNINGS_AS_ERRORS}>:$<BUILD_INTERFACE:-Werror>>)
if(GOTAI_SANITIZE)
  target_compile_options(gotai_options INTERFACE
    $<BUILD_INTERFACE:-fsanitize=${GOTAI_SANITIZE};-fno-omit-frame-pointer;-fno-sanitize-recover=all>
    # With sanitizers GCC 12 takes the standard library's own variables for uninitialised ones.
    $<$<CXX_COMPILER_ID:GNU>:$<BUILD_INTERFACE:-Wno-maybe-uninitialized>>)
  target_link_options(gotai_options INTERFACE $<BUILD_INTERFACE:-fsanitize=${GOTAI_SANITIZE}>)
endif()
if(GOTAI_SANITIZE MATCHES "thread")
  target_include_directories(gotai_options BEFORE INTERFACE
    $<BUILD_INTERFACE:${CMAKE_CURRENT_LIST_DIR}/thread_sanitizer>)
endif()
install(TARGETS gotai_options EXPORT gotaiTargets)

set(GOTAI_MODULES "" CACHE INTERNAL "")

# gotai_add_module(name DEPENDS other modules... PUBLIC_LINK libraries... PRIVATE_LINK libraries...)
# Compiles every .cpp in the calling folder.
function(gotai_add_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;PUBLIC_LINK;PRIVATE_LINK" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(NOT sources)
    return()
  endif()
  set(target gotai_${name})
  add_library(${target} STATIC ${sources})
  add_library(gotai::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:gotai_options> ${ARG_PRIVATE_LINK})
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC_LINK})
  foreach(dependency IN LISTS ARG_DEPENDS)
    if(TARGET gotai_${dependency})
      target_link_libraries(${target} PUBLIC gotai_${dependency})
    endif()
  endforeach()
  install(TARGETS ${target} EXPORT gotaiTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/gotai/${name}
    FILES_MATCHING PATTERN "*.h")
  set(GOTAI_MODULES ${GOTAI_MODULES} ${name} CACHE INTERNAL "")
endfunction()
