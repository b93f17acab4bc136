# What is lacking is named with the packages that have it, of four kinds of systems: each dependency is hidden in turn, from
# the build and from a program that uses the installed copy, and what CMake says is compared. Run as
# cmake -D project=... -D consumer=... -D installed=... -D folder=... -D compiler=... -D generator=... -D sundials=... -P
cmake_minimum_required(VERSION 3.22)
set(hidden Eigen3:libeigen3-dev:eigen3-devel:eigen:eigen
           Boost:libboost-dev:boost-devel:boost:libboost-headers
           nlohmann_json:nlohmann-json3-dev:json-devel:nlohmann-json:nlohmann_json
           SUNDIALS:libsundials-dev:sundials-devel:sundials:sundials
           GTest:libgtest-dev:gtest-devel:googletest:gtest
           Python:python3-dev:python3-devel:python:python
           pybind11:python3-pip:pybind11-devel:pybind11:pybind11)
set(of_a_user Eigen3 Boost nlohmann_json SUNDIALS)

function(expect source name packages way_out)
  set(hide "-DCMAKE_DISABLE_FIND_PACKAGE_${name}=ON")
  if(name STREQUAL "SUNDIALS")
    set(hide "-DCMAKE_IGNORE_PATH=${sundials}")
  elseif(name STREQUAL "pybind11")
    list(APPEND hide -DRBDYN_PYTHON=ON "-DPython_EXECUTABLE=${python}")
  elseif(name STREQUAL "Python")
    list(APPEND hide -DRBDYN_PYTHON=ON)
  endif()
  file(REMOVE_RECURSE "${folder}")
  execute_process(COMMAND "${CMAKE_COMMAND}" -S "${source}" -B "${folder}" -G "${generator}" "-DCMAKE_CXX_COMPILER=${compiler}"
                  "-DCMAKE_PREFIX_PATH=${installed}" ${hide} RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE said)
  string(REGEX REPLACE "[ \n]+" " " said "${said}")
  foreach(words IN LISTS packages)
    string(FIND "${said}" "${words}" place)
    if(place EQUAL -1)
      message(FATAL_ERROR "without ${name}, ${source} does not say \"${words}\":\n${said}")
    endif()
  endforeach()
  string(FIND "${said}" "${way_out}" place)
  if(result EQUAL 0 OR place EQUAL -1)
    message(FATAL_ERROR "without ${name}, ${source} ends with ${result} and does not say \"${way_out}\":\n${said}")
  endif()
endfunction()

foreach(line IN LISTS hidden)
  string(REPLACE ":" ";" line "${line}")
  list(POP_FRONT line name)
  list(GET line 0 apt)
  list(GET line 1 dnf)
  list(GET line 2 brew)
  list(GET line 3 conda)
  set(packages "apt install ${apt}" "dnf install ${dnf}" "brew install ${brew}" "conda install -c conda-forge ${conda}")
  set(way_out "CMAKE_PREFIX_PATH")
  if(name STREQUAL "SUNDIALS")
    set(way_out "-DRBDYN_SUNDIALS=OFF")
  elseif(name STREQUAL "GTest")
    set(way_out "-DRBDYN_TESTS=OFF")
  endif()
  expect("${project}" "${name}" "${packages}" "${way_out}")
  if(name IN_LIST of_a_user)
    if(name STREQUAL "SUNDIALS")
      set(way_out "COMPONENTS core")
    endif()
    expect("${consumer}" "${name}" "${packages}" "${way_out}")
  endif()
endforeach()
