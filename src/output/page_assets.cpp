#include "pellicle/output/page_assets.h"

// The assembler reads the files; a byte of zero behind each keeps the next one apart.
#define PELLICLE_EMBED(name, file)                                                                                 \
  __asm__(".pushsection .rodata\n" #name "_begin:\n.incbin \"" file "\"\n" #name "_end:\n.byte 0\n.popsection\n"); \
  extern "C" const char name##_begin[] __asm__(#name "_begin");                                                    \
  extern "C" const char name##_end[] __asm__(#name "_end")

// NOLINTBEGIN(cppcoreguidelines-avoid-c-arrays,modernize-avoid-c-arrays)
PELLICLE_EMBED(pellicle_page_template, PELLICLE_PAGE_FOLDER "/report.html");
PELLICLE_EMBED(pellicle_page_style, PELLICLE_PAGE_FOLDER "/report.css");
PELLICLE_EMBED(pellicle_page_script, PELLICLE_PAGE_FOLDER "/report.js");
PELLICLE_EMBED(pellicle_niivue_gzip, PELLICLE_NIIVUE_FOLDER "/niivue.umd.js.gz");
PELLICLE_EMBED(pellicle_niivue_licence, PELLICLE_NIIVUE_FOLDER "/LICENSE");
// NOLINTEND(cppcoreguidelines-avoid-c-arrays,modernize-avoid-c-arrays)

namespace pellicle {

namespace {

std::string_view between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

std::string_view page_template() {
  return between(pellicle_page_template_begin, pellicle_page_template_end);
}
std::string_view page_style() {
  return between(pellicle_page_style_begin, pellicle_page_style_end);
}
std::string_view page_script() {
  return between(pellicle_page_script_begin, pellicle_page_script_end);
}
std::string_view niivue_gzip() {
  return between(pellicle_niivue_gzip_begin, pellicle_niivue_gzip_end);
}
std::string_view niivue_licence() {
  return between(pellicle_niivue_licence_begin, pellicle_niivue_licence_end);
}

}  // namespace pellicle
