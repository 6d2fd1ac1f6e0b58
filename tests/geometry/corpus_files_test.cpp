// SPDX-License-Identifier: GPL-3.0-or-later
// One file per defect of form, with the exact error or the exact notes.
#include <limits>

#include "base/error.hpp"
#include "geometry/import/raw_mesh.hpp"
#include "tests/base/replaced.hpp"
#include "tests/geometry/formats.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

const std::map<std::string, std::string> kSound = InAllFormats(Polygons(BoxShape({0, 0, 0}, {1, 2, 3})));

std::string UpperCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string Cut(const std::string& bytes, size_t size) { return bytes.substr(0, size); }

template <typename T>
std::string Written(std::string bytes, size_t at, T value) {
  std::memcpy(&bytes[at], &value, sizeof value);
  return bytes;
}

std::string PlyText(const std::string& header, const std::string& values) {
  return "ply\n" + header + "end_header\n" + values;
}
const char* const kXyz = "property float x\nproperty float y\nproperty float z\n";
const char* const kCorners = "property list uchar int vertex_indices\n";

struct File {
  std::string name, bytes;
  std::string error;                 ///< of the whole; empty when the file is read
  std::vector<std::string> notes{};  ///< when it is read
  size_t triangles = 12;
};

std::vector<File> StlFiles() {
  const std::string binary = kSound.at("stl"), text = kSound.at("stl text");
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  return {
      {"empty", "", "part: the file is empty"},
      {"a header alone", Cut(binary, 84),
       "part, byte 80: the header promises 12 facets, the 84 bytes of the file hold 0: the file is cut off "
       "or not an STL"},
      {"below a header", Cut(binary, 83),
       "part, byte 83: the file ends after 83 bytes; a binary STL has at least 84"},
      {"no facets", Written<uint32_t>(Cut(binary, 84), 80, 0), "part: the file holds no triangles"},
      {"cut off", Cut(binary, 84 + 50 * 7 + 3),
       "part, byte 80: the header promises 12 facets, the 437 bytes of the file hold 7: the file is cut off "
       "or not an STL"},
      {"the largest count", Written<uint32_t>(binary, 80, 0xffffffff),
       "part, byte 80: the header promises 4294967295 facets, the 684 bytes of the file hold 12: the file is "
       "cut off or not an STL"},
      {"not a number", Written(binary, 84 + 12, nan),
       "part, byte 96: facet 1: vertex (nan, 0, 0) is not finite"},
      {"infinite", Written(binary, 84 + 50 * 11 + 12 + 32, inf),
       "part, byte 670: facet 12: vertex (1, 0, inf) is not finite"},
      {"bytes behind", binary + "tail", "", {"4 bytes behind the last facet were ignored"}},
      {"a header that begins with solid", Replaced(binary, "     ", "solid"), ""},
      {"a header that begins with solid facet", Replaced(binary, std::string(12, ' '), "solid\nfacet "), ""},
      {"a count that is too small",
       Written<uint32_t>(binary, 80, 11),
       "",
       {"50 bytes behind the last facet were ignored"},
       11},
      {"upper case", UpperCase(text), ""},
      {"CRLF", Everywhere(text, "\n", "\r\n"), ""},
      {"CR", Everywhere(text, "\n", "\r"), ""},
      {"tabs and blanks", Everywhere(text, " ", " \t "), ""},
      {"no endsolid", Replaced(text, "endsolid part\n", ""), "", {"\"endsolid\" is missing at the end"}},
      {"two solids", text + text, "", {}, 24},
      {"no normals", Everywhere(text, "facet normal 0 0 0", "facet"), ""},
      {"broken normals", Everywhere(text, "normal 0 0 0", "normal nan inf x"), ""},
      {"a word for a number", Replaced(text, "vertex 1 2 0", "vertex 1 2x 0"),
       "part:6:10: expected a finite number, found \"2x\""},
      {"nan as text", Replaced(text, "vertex 1 2 0", "vertex 1 nan 0"),
       "part:6:10: expected a finite number, found \"nan\""},
      {"beyond a double", Replaced(text, "vertex 1 2 0", "vertex 1 1e999 0"),
       "part:6:10: expected a finite number, found \"1e999\""},
      {"two vertices", Replaced(text, "vertex 1 2 0\n", ""),
       "part:6:1: expected \"vertex\", found \"endloop\""},
      {"four vertices", Replaced(text, "vertex 1 2 0\n", "vertex 1 2 0\nvertex 1 2 0\n"),
       "part:7:1: expected \"endloop\", found \"vertex\""},
      {"text cut off", Cut(text, text.find("endfacet")),
       "part:8:1: expected \"endfacet\", found the end of the file"},
      {"text without facets", "solid part\nendsolid part\n", "part: the file holds no triangles"},
      {"rubbish", std::string(200, 'x'),
       "part:1:1: text of no known mesh format begins with \"" + std::string(60, 'x') +
           "…\"; STL, OBJ, PLY, OFF, STEP, IGES and 3MF are read"}};
}

std::vector<File> ObjFiles() {
  const std::string text = kSound.at("obj"), first = "f 1 4 2\n";
  const auto with = [&](const std::string& face) {
    return Replaced(text, text.substr(text.find("f "), text.find('\n', text.find("f ")) - text.find("f ")),
                    face);
  };
  return {
      {"index 0", with("f 0 1 2"), "part:9:3: a face needs vertices from 1 to 8 (or -1 to -8), found \"0\""},
      {"an index beyond", with("f 1 2 9"),
       "part:9:7: a face needs vertices from 1 to 8 (or -1 to -8), found \"9\""},
      {"a negative index beyond", with("f 1 2 -9"),
       "part:9:7: a face needs vertices from 1 to 8 (or -1 to -8), found \"-9\""},
      {"an index that is no number", with("f 1 2 x/1"),
       "part:9:7: a face needs vertices from 1 to 8 (or -1 to -8), found \"x/1\""},
      {"two corners", with("f 1 2"), "part:9:5: a face needs three vertices or more, found 2"},
      {"nan", Replaced(text, "v 0 0 0", "v 0 nan 0"), "part:1:5: expected a finite number, found \"nan\""},
      {"a vertex of two numbers", Replaced(text, "v 0 0 0\n", "v 0 0\n"),
       "part:2:1: expected a finite number, found \"v\""},
      {"vertices alone", text.substr(0, text.find("f ")), "part: the file holds no triangles"},
      {"texture and normals",
       Everywhere(Everywhere(text, "f ", "vt 0 0\nvn 0 0 1\nusemtl steel\ng side\nf "), "v 0 0 0",
                  "# comment\nmtllib a.mtl\nv 0 0 0"),
       ""},
      {"unknown keywords", text + "curv2 1 2\ncurv2 3 4\n", "", {"2 lines \"curv2\" were ignored"}},
      {"a line that goes on", Replaced(text, "f ", "f \\\n"), ""},
      {"a colour behind the vertex", Replaced(text, "v 0 0 0", "v 0 0 0 0.5 0.5 0.5"), ""}};
}

std::vector<File> PlyFiles() {
  const std::string ascii = kSound.at("ply"), little = kSound.at("ply little");
  const size_t values = little.find("end_header\n") + 11;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {{"no end_header", Replaced(ascii, "end_header\n", ""),
           "part:9:1: \"0\" does not belong into a PLY header"},
          {"a header alone", "ply\nformat ascii 1.0\n", "part:3:1: the header has no \"end_header\""},
          {"an unknown format", Replaced(ascii, "ascii", "utf8"),
           "part:2:8: \"utf8\" is no PLY format; there are ascii, binary_little_endian, binary_big_endian"},
          {"an unknown type", Replaced(ascii, "double x", "real x"), "part:4:10: \"real\" is no PLY type"},
          {"a property before its element", PlyText("format ascii 1.0\nproperty float x\n", ""),
           "part:3:1: a property stands before the first element"},
          {"a list counted in floats", Replaced(ascii, "list uchar", "list float"),
           "part:8:15: the length of a list must be a whole number"},
          {"a count beyond the file", Replaced(ascii, "vertex 8", "vertex 80000"),
           "part:3:16: 80000 elements \"vertex\" do not fit into the 144 bytes behind the header"},
          {"the largest count", Replaced(little, "face 12", "face 2147483647"),
           "part:7:14: 2147483647 elements \"face\" do not fit into the 348 bytes behind the header"},
          {"a negative count", Replaced(ascii, "face 12", "face -1"),
           "part:7:14: the number of elements must be a whole number from 0 to 2147483648, found \"-1\""},
          {"no z", Replaced(ascii, "double z", "double w"), "part: the vertices lack x, y or z"},
          {"an index beyond",
           PlyText(std::string("format ascii 1.0\nelement vertex 3\n") + kXyz + "element face 1\n" + kCorners,
                   "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
           "part:13:7: a face's vertex must be from 0 to 2, found 3"},
          {"a negative index",
           PlyText(std::string("format ascii 1.0\nelement vertex 3\n") + kXyz + "element face 1\n" + kCorners,
                   "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"),
           "part:13:7: a face's vertex must be from 0 to 2, found -1"},
          {"half an index",
           PlyText(std::string("format ascii 1.0\nelement vertex 3\n") + kXyz +
                       "element face 1\nproperty list uchar float vertex_indices\n",
                   "0 0 0\n1 0 0\n0 1 0\n3 0 0.5 2\n"),
           "part:13:5: a face's vertex must be from 0 to 2, found 0.5"},
          {"a face of too many corners",
           PlyText(std::string("format ascii 1.0\nelement vertex 3\n") + kXyz +
                       "element face 1\nproperty list int int vertex_indices\n",
                   "0 0 0\n1 0 0\n0 1 0\n2000 0 1 2\n"),
           "part:13:1: a face of 2000 corners; 0 to 1000 are possible"},
          {"nan as text", Replaced(ascii, "end_header\n0 0 0", "end_header\n0 nan 0"),
           "part:10:3: expected a finite number, found \"nan\""},
          {"nan in bytes", Written(little, values + 8, nan),
           "part, byte " + std::to_string(values + 8) + ": vertex 0: nan is not finite"},
          {"cut off in its faces", Cut(little, little.size() - 2),
           "part, byte " + std::to_string(little.size() - 4) + ": the file ends within its values"},
          {"text cut off in its faces", Cut(ascii, ascii.size() - 3),
           "part:29:6: expected a finite number, found the end of the file"},
          {"elements and properties of others",
           Replaced(Replaced(ascii, "end_header\n", "element edge 1\nproperty int a\nend_header\n"),
                    "element vertex", "comment made by hand\nelement vertex") +
               "5\n",
           "",
           {"1 elements \"edge\" were ignored"}},
          {"no faces", PlyText(std::string("format ascii 1.0\nelement vertex 1\n") + kXyz, "0 0 0\n"),
           "part: the file holds no triangles"}};
}

std::vector<File> OffFiles() {
  const std::string text = kSound.at("off");
  return {
      {"four dimensions", Replaced(text, "OFF", "4OFF"), "part:1:1: \"4OFF\" has more than three dimensions"},
      {"binary", Replaced(text, "OFF", "OFF BINARY"),
       "part:1:5: binary OFF is not supported; export STL or PLY"},
      {"a count beyond the file", Replaced(text, "8 12 0", "800000 12 0"),
       "part:2:1: the number of vertices (by the size of the file) must be a whole number from 0 to 26, "
       "found \"800000\""},
      {"more faces than there are", Replaced(text, "8 12 0", "8 13 0"),
       "part:23:1: the number of a face's corners must be a whole number from 1 to 1000, found the end of "
       "the file"},
      {"an index beyond", Replaced(text, "3 0 ", "3 8 "),
       "part:11:3: a face's vertex must be a whole number from 0 to 7, found \"8\""},
      {"nan", Replaced(text, "0\n0 0 0", "0\n0 0 nan"), "part:3:5: expected a finite number, found \"nan\""},
      {"cut off in its vertices", Cut(text, text.find("1 2 3\n")),
       "part:10:1: expected a finite number, found the end of the file"},
      {"colours and comments",
       Replaced(Replaced(text, "OFF", "# made by hand\nCOFF"), "0 0 0\n", "0 0 0 255 0 0 255 # red\n"), ""},
      {"no edges counted", Replaced(text, "8 12 0", "8 12"), ""}};
}

TEST(CorpusFiles, EveryDefectOfFormHasItsOutcome) {
  size_t count = 0;
  for (const auto& [format, files] : {std::pair("stl", StlFiles()), std::pair("obj", ObjFiles()),
                                      std::pair("ply", PlyFiles()), std::pair("off", OffFiles())})
    for (const File& file : files) {
      SCOPED_TRACE(std::string(format) + ": " + file.name);
      ++count;
      try {
        const RawMesh mesh = ReadMesh(file.bytes, "part");
        EXPECT_EQ(file.error, "");
        EXPECT_EQ(mesh.notes, file.notes);
        EXPECT_EQ(mesh.triangles.faces.size(), file.triangles);
      } catch (const InputError& error) {
        EXPECT_EQ(error.what(), file.error);
      }
    }
  EXPECT_GT(count, 60u);
}

}  // namespace
}  // namespace millpose
