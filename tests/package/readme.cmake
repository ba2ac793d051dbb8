# The example in the README is the program that package.drop builds and runs.
file(READ ${SOURCE}/README.md readme)
file(READ ${SOURCE}/examples/cpp/drop.cpp program)
string(REGEX REPLACE "^//[^\n]*\n" "" program "${program}")
string(FIND "${readme}" "```cpp\n${program}```" place)
if(place EQUAL -1)
  message(FATAL_ERROR "README.md does not show examples/cpp/drop.cpp as it is")
endif()
