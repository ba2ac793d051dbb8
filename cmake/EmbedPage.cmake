# cmake -DOUTPUT=x.cpp [-DINPUT=page.html] -P EmbedPage.cmake: a C++ source with the file's bytes.
set(bytes "")
if(INPUT)
  file(READ ${INPUT} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
endif()
file(WRITE ${OUTPUT} "// Generated from viewer/.
#include \"gotai/view/page.h\"

namespace gotai::view {
namespace {
constexpr unsigned char kPage[] = {${bytes}0};
}
std::string_view page_template() {
  return {reinterpret_cast<const char*>(kPage), sizeof(kPage) - 1};
}
}  // namespace gotai::view
")
