# Counts lines of code of the headers that are rbdyn's and the standard library's: all but Eigen's own.
function(count_lines text result)
  file(WRITE "${folder}/counted.cpp" "${text}")
  execute_process(COMMAND "${compiler}" -std=c++20 -E -P "-I${include}" -isystem "${eigen}" "${folder}/counted.cpp"
                  OUTPUT_FILE "${folder}/counted.txt" COMMAND_ERROR_IS_FATAL ANY)
  # by their ends: a list of the lines themselves would take brackets and semicolons for its own
  file(READ "${folder}/counted.txt" text)
  string(REGEX MATCHALL "\n" ends "${text}")
  list(LENGTH ends count)
  set(${result} ${count} PARENT_SCOPE)
endfunction()
count_lines("#include <Eigen/Geometry>\n" eigen_lines)
count_lines("#include <rbdyn/rbdyn.hpp>\nint main() {}\n" lines)
math(EXPR more "${lines} - ${eigen_lines}")
message(STATUS "three lines are ${lines} lines with their headers, ${more} more than Eigen's")
# before headers declared and a library defined they were 42,200 more
# (16,900 without joints between bodies, constraints, contacts and pair laws; 18,500 without points of bodies, words of
# all joints for actions, engines of a build and warnings of memory; 18,640 without what is said of mistakes in functors; 18,710 without
# vectors beside Eigen's, variables of own models by name, and things that stay whole when they are moved from; 18,790 without
# inverses of hyperbolic functions; 18,840 without machine code for values, which programs keep; 18,940 without conditions of any length, and
# contacts that feel each other or bounce by turns; 18,970 without code that chunks of a program share; 18,990 without bodies that copies of
# scenes share)
if(more GREATER 19020)
  message(FATAL_ERROR "rbdyn/rbdyn.hpp has grown: what a program does not name belongs into a file of definitions (.ipp)")
endif()
