# Given to CMake as CMAKE_PROJECT_rbdyn_INCLUDE, with RBDYN_MUTANTS naming the folder that mutate.py wrote: the library is
# compiled from the definitions there, and all else from what is there anyway.
cmake_language(EVAL CODE "
  cmake_language(DEFER CALL target_include_directories rbdyn_objects BEFORE PRIVATE \"${RBDYN_MUTANTS}/include\")
  cmake_language(DEFER CALL target_compile_options rbdyn_objects PRIVATE -O1 -w)
  cmake_language(DEFER CALL set_target_properties rbdyn_objects PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 7)")
