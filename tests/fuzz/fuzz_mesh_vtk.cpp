#include "fuzz_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return gotai::fuzz::read_mesh("fuzz.vtk", data, size);
}
