# SPDX-License-Identifier: GPL-3.0-or-later
# A unity build: sources of a target are compiled in groups, since most of the time goes to what they include. A clean
# build takes a fifth less processor time; a change of one source compiles its group again. docs/decisions/0066 has figures.
#
# cmake/source-groups.awk chooses the groups such that no name of one source hides one of another. It does so when CMake
# configures: where a new name clashes later ("redefinition"), configure again.
function(trellis_unity_build)
  find_program(AWK NAMES mawk gawk awk REQUIRED)
  set(folders ${PROJECT_SOURCE_DIR})
  set(lines "")
  set(at 0)
  list(LENGTH folders count)
  while(at LESS count)
    list(GET folders ${at} folder)
    get_property(below DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
    get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
    list(APPEND folders ${below})
    foreach(target IN LISTS targets)
      get_target_property(type ${target} TYPE)
      if(NOT type MATCHES "^(STATIC_LIBRARY|OBJECT_LIBRARY|EXECUTABLE)$")
        continue()
      endif()
      get_target_property(sources ${target} SOURCES)
      foreach(source IN LISTS sources)
        cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder})
        # CMake itself leaves out sources with options or definitions of their own.
        cmake_path(IS_PREFIX PROJECT_BINARY_DIR ${source} made)
        if(source MATCHES "[.]cpp$" AND NOT made)
          string(APPEND lines "${target}\t${source}\n")
        endif()
      endforeach()
    endforeach()
    math(EXPR at "${at} + 1")
    list(LENGTH folders count)
  endwhile()

  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/source-groups.awk)
  set(list ${PROJECT_BINARY_DIR}/unity-sources)
  file(WRITE ${list} "${lines}")
  set(root ${PROJECT_SOURCE_DIR})
  # CGAL's sources take the longest, so each is compiled alone.
  execute_process(COMMAND ${AWK} -v folders=${root}/runtime/include:${root}/runtime:${root}:${root}/dsl/testing:${root}/dsl/program:${root}/tests
                          -v most=3000 -v alone=^CGAL/ -f ${root}/cmake/source-groups.awk ${list}
                  OUTPUT_VARIABLE groups COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[^\n]+" lines "${lines}")
  string(REGEX MATCHALL "[^\n]+" groups "${groups}")
  foreach(line IN LISTS lines)
    string(REGEX MATCH "^([^\t]+)\t(.*)$" line "${line}")
    set(target_of_${CMAKE_MATCH_2} ${CMAKE_MATCH_1})
  endforeach()
  foreach(line IN LISTS groups)
    string(REGEX MATCH "^([^\t]+)\t(.*)$" line "${line}")
    set(target ${target_of_${CMAKE_MATCH_1}})
    set_source_files_properties(${CMAKE_MATCH_1} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${CMAKE_MATCH_2})
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  endforeach()
endfunction()
