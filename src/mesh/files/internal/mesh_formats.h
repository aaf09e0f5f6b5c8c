#pragma once
/// One reader and one writer per format. Readers get the file's bytes and its name for
/// messages; they check every count against the bytes that are there before they allocate. Writers return the bytes.

#include <string>
#include <string_view>
#include <vector>

#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle::mesh_formats {

/// Where a message says that it happened.
struct Source {
  std::string_view bytes;
  std::string name;
};

TriangleMesh read_ply(const Source& source);
TriangleMesh read_stl(const Source& source);
TriangleMesh read_obj(const Source& source);
TriangleMesh read_off(const Source& source);
TriangleMesh read_vtp(const Source& source);
TriangleMesh read_gii(const Source& source);

std::string write_ply(const TriangleMesh& mesh);
std::string write_stl(const TriangleMesh& mesh);
std::string write_obj(const TriangleMesh& mesh);
std::string write_vtp(const TriangleMesh& mesh);
std::string write_gii(const TriangleMesh& mesh);

/// \throws BadData "cannot read mesh (NAME): WHY".
[[noreturn]] void fail(const Source& source, const std::string& why);
/// Whole numbers within int that name one of `count` vertices.
/// \throws BadData.
int checked_index(const Source& source, double value, std::size_t count);
/// Triangles 0-1-2, 0-2-3, ... of one polygon.
void add_fan(TriangleMesh& mesh, const std::vector<int>& polygon);
/// Turns a mesh in RAS into LPS, or back. Half a turn about z: the winding stays.
void flip_lps_ras(TriangleMesh& mesh);

/// Words and lines of a text held in memory, numbers independent of the locale.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : rest_(text) {}
  bool next_line(std::string_view& line);
  std::string_view rest() const { return rest_; }
  /// Next word, an empty one at the end.
  std::string_view next_word();

 private:
  std::string_view rest_;
};
std::string lower_case(std::string_view text);
bool parse_number(std::string_view word, double& value);

/// Base64 and zlib. Whitespace is skipped; false when the text is not base64.
std::string base64_encode(std::string_view bytes);
bool base64_decode(std::string_view text, std::string& bytes);
std::string zlib_compress(std::string_view bytes);
/// False unless the data unpack to exactly `size` bytes.
bool zlib_expand(std::string_view packed, std::size_t size, std::string& bytes);

}  // namespace pellicle::mesh_formats
