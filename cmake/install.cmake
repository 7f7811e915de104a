# SPDX-License-Identifier: GPL-3.0-or-later
# What is installed, in two components: `trellis`, the program with what belongs to it, and `libtrellis-dev`, the C++
# library. The program holds the standard library; the copies of its sources and the stubs are for readers and editors.
include(CMakePackageConfigHelpers)

get_property(layers GLOBAL PROPERTY TRELLIS_LAYERS)
# All that is installed and has to be built.
add_custom_target(trellis_installed DEPENDS trellis trellis_documents ${layers})
if(TARGET trellis-mesh)
  add_dependencies(trellis_installed trellis-mesh)
endif()
# Before anything is copied: a build of some targets alone would be installed half.
function(require_built component)
  install(CODE "foreach(file IN ITEMS \"$<JOIN:${ARGN},\" \">\")
  if(NOT EXISTS \"\${file}\")
    message(FATAL_ERROR \"Nothing was installed: \${file} is not built yet. Run 'cmake --build ${PROJECT_BINARY_DIR} \"
                        \"--target trellis_installed', then install again.\")
  endif()
endforeach()" COMPONENT ${component})
endfunction()
set(needed "$<TARGET_FILE:trellis>")
foreach(file trellis.1 trellis.bash trellis.fish _trellis meta/trellis.lua)
  list(APPEND needed "${PROJECT_BINARY_DIR}/dsl/${file}")
endforeach()
if(TARGET trellis-mesh)
  list(APPEND needed "$<TARGET_FILE:trellis-mesh>")
endif()
require_built(trellis "${needed}")
set(needed "")
foreach(layer ${layers})
  get_target_property(type ${layer} TYPE)
  if(type STREQUAL STATIC_LIBRARY)
    list(APPEND needed "$<TARGET_FILE:${layer}>")
  endif()
endforeach()
require_built(libtrellis-dev "${needed}")

set(data ${CMAKE_INSTALL_DATADIR}/trellis)
set(program DESTINATION ${data} COMPONENT trellis)

install(TARGETS trellis RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT trellis)
if(TARGET trellis-mesh)
  install(TARGETS trellis-mesh RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/trellis COMPONENT trellis)
endif()
install(DIRECTORY stdlib ${program} FILES_MATCHING PATTERN "*.lua")
install(FILES ${PROJECT_BINARY_DIR}/dsl/meta/trellis.lua DESTINATION ${data}/stdlib/meta COMPONENT trellis)
install(DIRECTORY examples ${program} FILES_MATCHING PATTERN "*.lua" PATTERN "*.cpp" PATTERN CMakeLists.txt
        PATTERN "*.slurm")
install(PROGRAMS examples/cluster/sweep-parallel DESTINATION ${data}/examples/cluster COMPONENT trellis)
# Draws figures, where Python has matplotlib and pandas.
install(DIRECTORY python/trellis DESTINATION ${data}/python COMPONENT trellis FILES_MATCHING PATTERN "*.py")
install(FILES .luacheckrc ${program} RENAME luacheckrc)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT trellis PATTERN site EXCLUDE)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT trellis RENAME copyright)
install(FILES LICENSES/MIT-0.txt DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT trellis)

set(printed ${PROJECT_BINARY_DIR}/dsl)
install(FILES ${printed}/trellis.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT trellis)
install(FILES ${printed}/trellis.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        COMPONENT trellis RENAME trellis)
install(FILES ${printed}/trellis.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT trellis)
install(FILES ${printed}/_trellis DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT trellis)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/trellis)
install(TARGETS ${layers} EXPORT trellis-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libtrellis-dev)
# The public headers: <trellis/trellis.hpp>, <trellis/eigen.hpp>, <trellis/ompl.hpp>, <trellis/planner/own_planner.hpp>,
# <trellis/program.hpp>, <trellis/testing.hpp>, and those that they include.
install(DIRECTORY runtime/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT libtrellis-dev FILES_MATCHING
        PATTERN "*.hpp")
install(FILES dsl/testing/trellis/testing.hpp dsl/program/trellis/program.hpp
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/trellis COMPONENT libtrellis-dev)
install(EXPORT trellis-targets NAMESPACE trellis:: DESTINATION ${package} COMPONENT libtrellis-dev)
configure_package_config_file(cmake/trellis-config.cmake.in ${PROJECT_BINARY_DIR}/trellis-config.cmake
                              INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/trellis-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/trellis-config.cmake ${PROJECT_BINARY_DIR}/trellis-config-version.cmake
        DESTINATION ${package} COMPONENT libtrellis-dev)

# cpack -G DEB: the two components as Debian packages.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The Trellis developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Guiding spaces for robot motion planning")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL trellis libtrellis-dev)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_TRELLIS_PACKAGE_NAME trellis)
set(CPACK_DEBIAN_TRELLIS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TRELLIS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TRELLIS_PACKAGE_RECOMMENDS "python3, python3-matplotlib, python3-pandas")
set(CPACK_DEBIAN_LIBTRELLIS-DEV_PACKAGE_NAME libtrellis-dev)
set(CPACK_DEBIAN_LIBTRELLIS-DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBTRELLIS-DEV_PACKAGE_DEPENDS
    "libboost-dev, libcgal-dev, libdlib-dev, libeigen3-dev, libfcl-dev, libfmt-dev, liblua5.4-dev, libpng-dev, libreadline-dev, libsqlite3-dev, libtinyxml2-dev, libyaml-cpp-dev, pkgconf")
set(CPACK_DEBIAN_LIBTRELLIS-DEV_PACKAGE_SUGGESTS catch2)
set(CPACK_DEBIAN_TRELLIS_DESCRIPTION
    "Scripts in Lua declare hierarchies of simpler spaces, each guiding the search\n\
in the one above it; trellis executes them and reports what each level cost\n\
and what it was worth.")
set(CPACK_DEBIAN_LIBTRELLIS-DEV_DESCRIPTION
    "The C++ library: the spaces, planners, guides and measures that trellis is built of, as static\n\
libraries with a CMake package, and matchers for tests of strategies in Catch2.")
include(CPack)
