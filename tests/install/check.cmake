# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the build in BUILD into the folder PLACE, and uses what lies there as a user would: runs an example, asks for
# help, sources the completions, and builds a project against the library with the compiler CXX.
file(REMOVE_RECURSE ${PLACE})
set(root ${PLACE}/root)

# run(RESULT COMMAND...): what the command prints; its failure fails the test.
function(run result)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE out ERROR_VARIABLE err RESULT_VARIABLE status WORKING_DIRECTORY ${PLACE})
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nended with ${status}\n${out}${err}")
  endif()
  set(${result} "${out}" PARENT_SCOPE)
endfunction()

function(expect what text pattern)
  if(NOT text MATCHES "${pattern}")
    message(FATAL_ERROR "${what}: expected '${pattern}' in\n${text}")
  endif()
endfunction()

file(MAKE_DIRECTORY ${PLACE})

# refused(FOLDER MISSING): an install of the build in FOLDER, which lacks MISSING, names it and what to build, and copies
# nothing.
function(refused folder missing)
  execute_process(COMMAND ${CMAKE_COMMAND} --install ${folder} --prefix ${folder}/prefix ${ARGN}
                  OUTPUT_VARIABLE out ERROR_VARIABLE err RESULT_VARIABLE status)
  if(status EQUAL 0)
    message(FATAL_ERROR "a build without ${missing} was installed")
  endif()
  string(REGEX REPLACE "[ \n]+" " " err "${err}")
  expect("the refusal" "${err}" "Nothing was installed: ${folder}/${missing} is not built yet")
  expect("the refusal" "${err}" "Run 'cmake --build ${folder} --target trellis_installed', then install again")
  if(EXISTS ${folder}/prefix)
    message(FATAL_ERROR "the refused install left ${folder}/prefix")
  endif()
endfunction()

# The same build of which the program alone is there, as after `cmake --build --target trellis`.
set(partial ${PLACE}/partial)
file(GLOB_RECURSE steps RELATIVE ${BUILD} ${BUILD}/cmake_install.cmake)
list(FILTER steps EXCLUDE REGEX "^tests/install/")
foreach(step ${steps})
  file(READ ${BUILD}/${step} text)
  string(REPLACE "${BUILD}/" "${partial}/" text "${text}")
  string(REPLACE "${BUILD} " "${partial} " text "${text}")
  file(WRITE ${partial}/${step} "${text}")
endforeach()
refused(${partial} trellis)
file(CREATE_LINK ${BUILD}/trellis ${partial}/trellis SYMBOLIC)
refused(${partial} dsl/trellis.1)
refused(${partial} dsl/trellis.1 --component trellis)
refused(${partial} "runtime/libtrellis_[a-z]+.a" --component libtrellis-dev)

run(ignored ${CMAKE_COMMAND} --install ${BUILD} --prefix ${root})
unset(ENV{TRELLIS_STDLIB})
set(ENV{PATH} "${root}/bin:$ENV{PATH}")

run(report trellis run ${root}/share/trellis/examples/minimal.lua)
expect("the report" "${report}" "cup")
run(ignored trellis new mine)
run(report trellis run mine.lua --seeds 1 --quiet --html report.html)
run(said trellis test mine_test.lua)
expect("the test" "${said}" "passed: 2 scenarios")
if(NOT EXISTS ${PLACE}/report.html)
  message(FATAL_ERROR "no page was written")
endif()

if(EXISTS ${BUILD}/trellis-mesh AND NOT EXISTS ${root}/libexec/trellis/trellis-mesh)
  message(FATAL_ERROR "the program that reads COLLADA was not installed")
endif()

foreach(file share/trellis/stdlib/strategies.lua share/trellis/stdlib/meta/trellis.lua share/trellis/examples/nested.lua share/trellis/python/trellis/figures/__main__.py
             share/doc/trellis/reference.md share/doc/trellis/README.md share/doc/trellis/copyright
             share/man/man1/trellis.1 share/bash-completion/completions/trellis
             share/fish/vendor_completions.d/trellis.fish share/zsh/vendor-completions/_trellis
             include/trellis/trellis.hpp include/trellis/testing.hpp include/trellis/eigen.hpp
             include/trellis/ompl.hpp include/trellis/strategy/sampler.hpp)
  if(NOT EXISTS ${root}/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
file(GLOB_RECURSE headers ${root}/include/*.hpp)
# Two headers are for users of Eigen and of OMPL; no other includes them, so that both stay optional. They do not count
# below.
list(REMOVE_ITEM headers ${root}/include/trellis/eigen.hpp ${root}/include/trellis/ompl.hpp)
foreach(header ${headers})
  file(STRINGS ${header} included REGEX "#include <nlohmann|#include <(CGAL|fcl|lua|Eigen|ompl|trellis/eigen|trellis/ompl)")
  if(included)
    message(FATAL_ERROR "${header} includes a third party's: ${included}")
  endif()
endforeach()
list(LENGTH headers count)
if(count GREATER 45)
  message(FATAL_ERROR "${count} headers are installed; the public ones are few")
endif()
run(page trellis reference man)
file(READ ${root}/share/man/man1/trellis.1 installed)
if(NOT page STREQUAL installed)
  message(FATAL_ERROR "the manual page is not what the program prints")
endif()

# The words that bash offers for the last one of a line.
function(complete result)
  run(out bash ${CMAKE_CURRENT_LIST_DIR}/complete.bash ${root}/share/bash-completion/completions/trellis ${ARGN})
  set(${result} "${out}" PARENT_SCOPE)
endfunction()
complete(found trellis ref)
expect("trellis ref" "${found}" "^reference\n$")
complete(found trellis run --se)
expect("trellis run --se" "${found}" "^--seeds\n--seed\n$")
complete(found trellis run x.lua --report l)
expect("--report l" "${found}" "^levels\n$")
complete(found trellis run m)
expect("trellis run m" "${found}" "^mine.lua\nmine_test.lua\n$")
complete(found trellis help strategies.relaxati)
expect("trellis help strategies.relaxati" "${found}" "^strategies.relaxation\n$")

run(ignored ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${PLACE}/consumer -G ${GENERATOR}
    -D CMAKE_PREFIX_PATH=${root} -D CMAKE_CXX_COMPILER=${CXX} -D CMAKE_CXX_FLAGS=${FLAGS}
    -D DOORWAY=${PLACE}/mine.lua)
run(ignored ${CMAKE_COMMAND} --build ${PLACE}/consumer)
run(said ${PLACE}/consumer/consumer)
expect("the consumer" "${said}" "^trellis [0-9.]+: skeleton\\(\\) >> rrt\\(\\) solved wall\n$")
run(said ${PLACE}/consumer/with_eigen)
expect("the consumer with Eigen" "${said}" "^mean 1 2, end 4 6, at -?[0-9.e-]+ +0 +1\n$")
run(said ${PLACE}/consumer/doorway_test)
expect("the consumer's test" "${said}" "All tests passed \\(2 assertions in 1 test case\\)")

# The command with a planner of one's own.
set(own ${root}/share/trellis/examples/planner)
run(ignored ${CMAKE_COMMAND} -S ${own} -B ${PLACE}/planner -G ${GENERATOR}
    -D CMAKE_PREFIX_PATH=${root} -D CMAKE_CXX_COMPILER=${CXX} -D CMAKE_CXX_FLAGS=${FLAGS})
run(ignored ${CMAKE_COMMAND} --build ${PLACE}/planner)
set(mine ${PLACE}/planner/my_trellis)
run(said ${mine} run ${own}/nested.lua --quiet --json own.json)
run(said ${mine} run ${own}/nested.lua)
expect("the guided planner" "${said}" "nested +10/10")
expect("the planner of a level" "${said}" "shrink")
run(said ${mine} help sampled_rrt)
expect("help" "${said}" "candidates +an integer")
run(said ${mine} reference markdown)
expect("the reference" "${said}" "sampled_rrt")
file(REMOVE_RECURSE ${PLACE})
