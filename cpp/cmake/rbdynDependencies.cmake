# Finds what rbdyn stands on; the build and an installed rbdyn both read this file.
# Targets: Eigen3::Eigen, Boost::headers, Threads::Threads, nlohmann_json::nlohmann_json and, if RBDYN_SUNDIALS, rbdyn::sundials. What is lacking is said in rbdyn_missing,
# all of it; how to do without SUNDIALS is for whoever reads this file to say, in rbdyn_without_sundials.
#
# SUNDIALS is looked for by file, not by its own package file: Debian's asks for OpenMP, MPI and PETSc, none of which CVODE
# needs. The static archive is preferred, so that what links it needs no SUNDIALS where it runs. To point at another copy,
# put its folder in CMAKE_PREFIX_PATH.
set(rbdyn_missing "")

# rbdyn_lack(TEXT WHAT APT DNF BREW CONDA): adds to a text what is not there, and the package that has it
function(rbdyn_lack text what apt dnf brew conda)
  set(${text} "${${text}}rbdyn needs ${what}, and CMake finds none:\n"
              "  apt install ${apt}  (Debian, Ubuntu)\n"
              "  dnf install ${dnf}  (Fedora)\n"
              "  brew install ${brew}  (Homebrew)\n"
              "  conda install -c conda-forge ${conda}\n"
              "If it is elsewhere, name its folder: -DCMAKE_PREFIX_PATH=...\n")
  string(CONCAT ${text} ${${text}})
  set(${text} "${${text}}" PARENT_SCOPE)
endfunction()

find_package(Eigen3 QUIET CONFIG)
if(NOT TARGET Eigen3::Eigen OR Eigen3_VERSION VERSION_LESS 3.4)
  rbdyn_lack(rbdyn_missing "Eigen 3.4 or later" libeigen3-dev eigen3-devel eigen eigen)
endif()

find_package(Boost 1.74 QUIET)
if(NOT TARGET Boost::headers)
  rbdyn_lack(rbdyn_missing "the headers of Boost 1.74 or later" libboost-dev boost-devel boost libboost-headers)
endif()

find_package(Threads QUIET)
if(NOT TARGET Threads::Threads)
  string(APPEND rbdyn_missing "rbdyn needs the threads of the C++ library, which this compiler cannot link.\n")
endif()

find_package(nlohmann_json 3.9 QUIET CONFIG)
if(NOT TARGET nlohmann_json::nlohmann_json)
  rbdyn_lack(rbdyn_missing "nlohmann's JSON 3.9 or later, for scenes as files" nlohmann-json3-dev json-devel nlohmann-json nlohmann_json)
endif()

if(RBDYN_SUNDIALS AND NOT TARGET rbdyn::sundials)
  find_path(RBDYN_SUNDIALS_INCLUDE cvode/cvode.h)
  find_library(RBDYN_SUNDIALS_CVODE NAMES libsundials_cvode.a sundials_cvode sundials_cvode_static)
  mark_as_advanced(RBDYN_SUNDIALS_INCLUDE RBDYN_SUNDIALS_CVODE)
  set(rbdyn_sundials_version 0)
  set(rbdyn_sundials_mpi 0)
  if(RBDYN_SUNDIALS_INCLUDE AND RBDYN_SUNDIALS_CVODE)
    file(STRINGS "${RBDYN_SUNDIALS_INCLUDE}/sundials/sundials_config.h" rbdyn_lines REGEX "define SUNDIALS_(VERSION|MPI_ENABLED) ")
    if(rbdyn_lines MATCHES "SUNDIALS_VERSION \"([0-9.]+)")
      set(rbdyn_sundials_version "${CMAKE_MATCH_1}")
    endif()
    if(rbdyn_lines MATCHES "SUNDIALS_MPI_ENABLED 1")
      set(rbdyn_sundials_mpi 1)
    endif()
  endif()
  set(rbdyn_sundials_parts "${RBDYN_SUNDIALS_CVODE}")
  if(rbdyn_sundials_version VERSION_LESS 6.4)
    rbdyn_lack(rbdyn_missing "SUNDIALS CVODE 6.4 or later, for the engines cvode-adams and cvode-bdf" libsundials-dev sundials-devel sundials
                sundials)
    string(APPEND rbdyn_missing "${rbdyn_without_sundials}\n")
  elseif(NOT rbdyn_sundials_version VERSION_LESS 7)
    # from 7 on contexts and vectors live in a library of their own, and an MPI build shows mpi.h in its headers
    get_filename_component(rbdyn_folder "${RBDYN_SUNDIALS_CVODE}" DIRECTORY)
    find_library(RBDYN_SUNDIALS_CORE NAMES libsundials_core.a sundials_core sundials_core_static HINTS "${rbdyn_folder}")
    mark_as_advanced(RBDYN_SUNDIALS_CORE)
    list(APPEND rbdyn_sundials_parts "${RBDYN_SUNDIALS_CORE}")
    if(NOT RBDYN_SUNDIALS_CORE)
      rbdyn_lack(rbdyn_missing "the sundials_core library of SUNDIALS ${rbdyn_sundials_version}, which it found" libsundials-dev sundials-devel sundials
                  sundials)
    elseif(rbdyn_sundials_mpi)
      find_package(MPI QUIET COMPONENTS CXX)
      list(APPEND rbdyn_sundials_parts MPI::MPI_CXX)
      if(NOT TARGET MPI::MPI_CXX)
        rbdyn_lack(rbdyn_missing "the headers of MPI, with which the SUNDIALS ${rbdyn_sundials_version} found was built" mpi-default-dev openmpi-devel
                    open-mpi openmpi)
      endif()
    endif()
  endif()
  if(NOT rbdyn_missing)
    add_library(rbdyn::sundials INTERFACE IMPORTED GLOBAL)
    if(UNIX)
      list(APPEND rbdyn_sundials_parts m)
    endif()
    set_target_properties(rbdyn::sundials PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${RBDYN_SUNDIALS_INCLUDE}"
                                                     INTERFACE_LINK_LIBRARIES "${rbdyn_sundials_parts}")
  endif()
endif()
