#include "pellicle/mesh/files/mesh_file.h"
#include "../temporary_folder.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <unistd.h>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/measure.h"
#include "test_meshes.h"

namespace pellicle {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class MeshFile : public testing::Test {
 protected:
  fs::path put(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }

  const test::TemporaryFolder temporary_;
  const fs::path& folder_ = temporary_.path();
};

std::string bytes_of(const fs::path& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

constexpr MeshFormat kAll[] = {MeshFormat::ply, MeshFormat::stl, MeshFormat::obj, MeshFormat::vtp, MeshFormat::gii};

TEST_F(MeshFile, RoundTrip) {
  TriangleMesh m = test::sphere(2, 31.7, {101.3, -57.9, 23.1});
  for (const MeshFormat format : kAll) {
    const fs::path path = folder_ / ("a" + extension_of(format));
    write_mesh(path, m, format);
    const TriangleMesh back = read_mesh(path);
    const bool single = format == MeshFormat::stl || format == MeshFormat::gii;
    ASSERT_EQ(back.vertices.size(), m.vertices.size());
    ASSERT_EQ(back.triangles.size(), m.triangles.size());
    double worst = 0.0;
    for (std::size_t f = 0; f < m.triangles.size(); ++f) {  // STL renumbers vertices: corner by corner
      for (std::size_t c = 0; c < 3; ++c) {
        worst = std::max(
            worst,
            (back.vertices[std::size_t(back.triangles[f][c])] - m.vertices[std::size_t(m.triangles[f][c])]).norm());
      }
    }
    EXPECT_LE(worst, single ? 1e-5 : 0.0) << extension_of(format);
    const bool keeps_normals = format == MeshFormat::ply || format == MeshFormat::obj || format == MeshFormat::vtp;
    EXPECT_EQ(back.normals.size(), keeps_normals ? m.normals.size() : 0U) << extension_of(format);
    EXPECT_TRUE(topology_of(back).closed);
    EXPECT_GT(volume_of(back), 0.0);
    const char* tag = format == MeshFormat::vtp ? "76 80 83" : format == MeshFormat::gii ? "SCANNER_ANAT" : "SPACE=LPS";
    EXPECT_THAT(bytes_of(path), HasSubstr(tag));
  }
}

TEST_F(MeshFile, NoHalfFileAndNamedErrors) {
  const TriangleMesh m = test::sphere(0, 1);
  EXPECT_THROW(write_mesh(folder_ / "missing" / "a.ply", m, MeshFormat::ply), CannotCreate);
  EXPECT_THROW(read_mesh(folder_ / "none.ply"), NoInput);
  EXPECT_THROW(read_mesh(folder_), BadData);
  EXPECT_EQ(mesh_format_from_name("GII"), MeshFormat::gii);
  EXPECT_THROW(mesh_format_from_name("step"), UsageError);
}

TEST_F(MeshFile, PlyVariants) {
  const std::string header =
      "comment made by hand\nelement vertex 4\nproperty uchar red\nproperty float z\nproperty short y\nproperty double "
      "x\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\n"
      "element face 2\nproperty uchar flag\nproperty list uint ushort vertex_index\nend_header\n";
  const TriangleMesh a =
      read_mesh(put("a.ply", "ply\nformat ascii 1.0\n" + header +
                                 "9 1 0 0\n9 2 1 0\n9 3 1 1\n9 4 0 1.5\n0 1\n7 4 0 1 2 3\n7 3 0 2 3\n"));
  ASSERT_EQ(a.triangles.size(), 3U);  // a quad in two, and a triangle
  EXPECT_EQ(a.vertices[3], Vec3(1.5, 0, 4));
  std::string big;
  const auto put_big = [&](const auto value) {
    const char* raw = reinterpret_cast<const char*>(&value);
    for (std::size_t i = sizeof value; i-- > 0;) big += raw[i];
  };
  for (const auto& [z, y, x] : {std::tuple(1.F, 0, 0.), {2.F, 1, 0.}, {3.F, 1, 1.}, {4.F, 0, 1.5}}) {
    put_big(std::uint8_t{9});
    put_big(z);
    put_big(static_cast<std::int16_t>(y));
    put_big(x);
  }
  put_big(0);
  put_big(1);
  for (const auto& face : {std::vector<int>{0, 1, 2, 3}, {0, 2, 3}}) {
    put_big(std::uint8_t{7});
    put_big(static_cast<std::uint32_t>(face.size()));
    for (const int i : face) put_big(static_cast<std::uint16_t>(i));
  }
  const TriangleMesh b = read_mesh(put("b.ply", "ply\nformat binary_big_endian 1.0\n" + header + big));
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST_F(MeshFile, FramesAreUndone) {
  const std::string body = "v 1 2 3\nv 2 2 3\nv 1 3 3\nf 1 2 3\n";
  EXPECT_EQ(read_mesh(put("a.obj", body)).vertices[0], Vec3(1, 2, 3));
  EXPECT_EQ(read_mesh(put("b.obj", "# SPACE=LPS\n" + body)).vertices[0], Vec3(1, 2, 3));
  EXPECT_EQ(read_mesh(put("c.obj", "# SPACE=RAS\n" + body)).vertices[0], Vec3(-1, -2, 3));
}

TEST_F(MeshFile, TextVariants) {
  const TriangleMesh quad = read_mesh(put("a.obj",
                                          "o q\r\nv 0 0 0 1 0 0\r\nv +1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvt 0 0\r\n"
                                          "vn 0 0 1\r\nf -4/1/1 -3/1/1 3//1 4 # c\r\n"));
  EXPECT_EQ(quad.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}}));
  const TriangleMesh off = read_mesh(put("b.off",
                                         "COFF # colours\n\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 0 0 0\n"
                                         "0 1e0 0 1 1 1 1\n3 0 1 2 0.5 0.5 0.5\n"));
  EXPECT_EQ(off.vertices[2], Vec3(0, 1, 0));
  EXPECT_EQ(read_mesh(put("c.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2")).triangles.size(), 1U);
  const TriangleMesh stl = read_mesh(put("d.stl",
                                         "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                                         "vertex 0 1 0\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\n"
                                         "vertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"));
  EXPECT_EQ(stl.vertices.size(), 4U);
  const TriangleMesh vtp = read_mesh(put(
      "e.vtp",
      "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"><PolyData><Piece "
      "NumberOfPoints=\"3\" "
      "NumberOfPolys=\"1\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 "
      "1 0"
      "</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" "
      "format=\"ascii\">3</DataArray></Polys></Piece></PolyData></VTKFile>"));
  EXPECT_EQ(vtp.triangles.size(), 1U);
}

TEST_F(MeshFile, MalformedFilesAreOneLineOfBadData) {
  const std::pair<std::string, std::string> cases[] = {
      {"empty.ply", ""},
      {"magic.ply", "plx\n"},
      {"header.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"},
      {"type.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n"},
      {"huge.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 2000000000\nproperty float x\nproperty float y\n"
       "property float z\nend_header\nabc"},
      {"list.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0\n4000000000 0 0\n"},
      {"index.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 1\n"},
      {"points.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
       "end_header\n0 0 0\n"},
      {"nan.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\nnan 0 0\n3 0 0 0\n"},
      {"short.stl", "solid"},
      {"count.stl", std::string(80, ' ') + "\xff\xff\xff\xff" + "abc"},
      {"ascii.stl", "solid x\nvertex 0 0 0\nvertex 1 0\n"},
      {"corner.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n"},
      {"zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"},
      {"text.obj", "v 0 zero 0\n"},
      {"huge.off", "OFF\n1000000000 1000000000 0\n0 0 0\n"},
      {"fraction.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n"},
      {"word.off", "FOO\n"},
      {"broken.vtp", "<VTKFile><PolyData>"},
      {"raw.vtp",
       "<VTKFile><PolyData><Piece><Points><DataArray type=\"Float32\" format=\"appended\" offset=\"0\"/></Points>"
       "</Piece></PolyData></VTKFile>"},
      {"length.vtp",
       "<VTKFile><PolyData><Piece><Points><DataArray type=\"Float32\" format=\"binary\">/////wAA</DataArray>"
       "</Points></Piece></PolyData></VTKFile>"},
      {"dims.gii",
       "<GIFTI><DataArray Intent=\"NIFTI_INTENT_POINTSET\" DataType=\"NIFTI_TYPE_FLOAT32\" Dimensionality=\"2\" "
       "Dim0=\"999999999\" Dim1=\"3\" Encoding=\"GZipBase64Binary\" Endian=\"LittleEndian\"><Data>eJwDAAAAAAE="
       "</Data></DataArray></GIFTI>"},
      {"none.gii", "<GIFTI></GIFTI>"},
      {"mesh.xyz", "0 0 0\n"},
  };
  for (const auto& [name, bytes] : cases) {
    const fs::path path = put(name, bytes);
    try {
      read_mesh(path);
      ADD_FAILURE() << name << " was read";
    } catch (const BadData& e) {
      EXPECT_THAT(e.what(), HasSubstr(name));
      EXPECT_THAT(e.what(), Not(HasSubstr("\n")));
    }
  }
}

// Every prefix of a good file, and random damage: an error or a mesh, nothing else.
TEST_F(MeshFile, DamagedFilesNeverCrash) {
  RandomEngine random(5);
  const TriangleMesh m = test::sphere(0, 10);
  for (const MeshFormat format : kAll) {
    const std::string extension = extension_of(format);
    write_mesh(folder_ / ("good" + extension), m, format);
    const std::string good = bytes_of(folder_ / ("good" + extension));
    for (int trial = 0; trial < 200; ++trial) {
      std::string bad = good;
      if (trial % 2 == 0) bad.resize(random.next() % good.size());
      for (int i = 0; i < trial % 4 && !bad.empty(); ++i)
        bad[random.next() % bad.size()] = static_cast<char>(random.next());
      try {
        check_indices(read_mesh(put("bad" + extension, bad)));
      } catch (const BadData&) {
      }
    }
  }
}

// Other readers see the same millimetres: nibabel for GIfTI, a few lines of Python for PLY, STL and VTP.
TEST_F(MeshFile, OtherReadersAgree) {
  const fs::path python = "/usr/bin/python3";
  if (!fs::exists(python) || std::system("/usr/bin/python3 -c 'import nibabel, numpy' 2>/dev/null") != 0) {
    GTEST_SKIP() << "python3-nibabel is not installed";
  }
  const TriangleMesh m = test::sphere(1, 20, {100, -50, 25});
  for (const MeshFormat format : kAll) write_mesh(folder_ / ("m" + extension_of(format)), m, format);
  std::ofstream truth(folder_ / "truth.txt");
  truth.precision(17);
  for (const auto& t : m.triangles) {
    for (const int i : t) truth << m.vertices[std::size_t(i)].transpose() << '\n';
  }
  truth.close();
  const std::string script = std::string(PELLICLE_SOURCE_DIR) + "/tests/mesh/read_back.py";
  const std::string command = python.string() + " '" + script + "' '" + folder_.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

// Meshes of known genus and some known to be broken, where the collection is at hand.
TEST(MeshCollection, KnownShapes) {
  const char* variable = std::getenv("PELLICLE_SHARED");
  const fs::path shapes =
      (variable != nullptr ? fs::path(variable) : fs::path(PELLICLE_SOURCE_DIR) / ".." / "shared") / "data/shapes";
  if (!fs::exists(shapes)) GTEST_SKIP() << "no shape collection (set PELLICLE_SHARED)";
  const std::map<std::string, int> genus = {{"3holes.off", 3},     {"bunny.off", 0},         {"cheburashka.off", 0},
                                            {"cow.off", 0},        {"decimated-max.obj", 0}, {"elephant.obj", 0},
                                            {"rocker-arm.obj", 1}, {"spot.obj", 0},          {"knot.ply", 1}};
  for (const auto& [name, expected] : genus) {
    const MeshTopology t = topology_of(read_mesh(shapes / name));
    EXPECT_TRUE(t.closed && t.manifold && t.oriented) << name << ": " << t.first_fault;
    EXPECT_EQ(t.genus, expected) << name;
    EXPECT_EQ(t.components, 1) << name;
  }
  for (const char* name : {"camelhead.off", "lion.off", "stanford-bunny.obj", "many_small_holes.ply"}) {
    const MeshTopology t = topology_of(read_mesh(shapes / name));
    EXPECT_FALSE(t.closed) << name;
    EXPECT_THAT(t.first_fault, HasSubstr("is open")) << name;
  }
  EXPECT_FALSE(topology_of(read_mesh(shapes / "gastruloid.ply")).manifold);
}

}  // namespace
}  // namespace pellicle
