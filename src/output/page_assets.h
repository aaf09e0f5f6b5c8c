#pragma once
/// The fixed parts of a report's page, held in the program itself.

#include <string_view>

namespace pellicle {

std::string_view page_template();   ///< HTML with {{PLACES}}
std::string_view page_style();      ///< CSS
std::string_view page_script();     ///< JavaScript
std::string_view niivue_gzip();     ///< the viewer's script, compressed
std::string_view niivue_licence();  ///< text

}  // namespace pellicle
