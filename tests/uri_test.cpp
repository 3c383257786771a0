// What URIs in glTF files mean: data of every spelling that RFC 2397 allows, and files by the path segments of RFC
// 3986.
#include <cstdio>
#include <random>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/scene/gltf/uri.h"
#include "tests/gltf_checks.h"

namespace wavepath {
namespace {

using gltf::decode_data_uri;
using gltf::resolve_uri;
using nlohmann::json;
using test::GltfBuilder;
using test::TempFolder;

std::string bytes_of(const std::string& uri) {
  EXPECT_TRUE(gltf::is_data_uri(uri)) << uri;
  const gltf::UriData data = decode_data_uri(uri);
  return data.problem.empty() ? std::string(data.bytes.begin(), data.bytes.end()) : "problem: " + data.problem;
}

TEST(Uri, DataOfEverySpelling) {
  for (const char* uri : {
           "data:application/octet-stream;base64,aGVsbG8+Pz8=",            // as most write it
           "data:application/octet-stream;BASE64,aGVsbG8+Pz8=",            // the mark in any case
           "data:application/gltf-buffer; Base64 ,aGVsbG8+Pz8=",           // and with blanks
           "DATA:application/octet-stream;base64,aGVsbG8+Pz8=",            // the scheme in any case
           " data:application/octet-stream;base64,aGVsbG8+Pz8=",           // a blank before all
           "data:;base64,aGVsbG8+Pz8=",                                    // no media type
           "data:text/plain;charset=utf-8;base64,aGVsbG8+Pz8=",            // a parameter
           "data:text/plain;a=b;name=\"x y\";base64,aGVsbG8+Pz8=",         // several
           "data:application/octet-stream;base64,aGVsbG8%2BPz8%3D",        // escaped
           "data:application/octet-stream;base64,%61GVsbG8%2bPz8%3d",      // needlessly, in small letters
           "data:application/octet-stream;base64,aGVsbG8+Pz8",             // without padding
           "data:application/octet-stream;base64,aGVs\r\n\tbG8+ Pz8=\n",   // in lines
           "data:application/octet-stream;base64,aGVs%0D%0AbG8%20+Pz8%3D", // in escaped lines
           "data:application/octet-stream;base64, aGVsbG8+Pz8= = ",        // more padding than needed
           "data:text/plain,hello>??",                                     // as text
           "data:,hello%3e%3F?",                                           // escaped, without media type
           "data:text/plain;charset=US-ASCII,hello%3E%3F%3F",
       })
    EXPECT_EQ(bytes_of(uri), "hello>??") << uri;
  EXPECT_EQ(bytes_of("data:;base64,AA=="), std::string(1, '\0'));
  EXPECT_EQ(bytes_of("data:;base64,AAA="), std::string(2, '\0'));
  EXPECT_EQ(bytes_of("data:;base64,"), "");
  EXPECT_EQ(bytes_of("data:,"), "");
  EXPECT_EQ(bytes_of("data:,100%"), "100%"); // no escape follows
  for (const char* name : {"dat:a", "data", "data.bin", "datax:,a", "database:,a", "x/data:,a", ""})
    EXPECT_FALSE(gltf::is_data_uri(name)) << name;
}

TEST(Uri, DataOfEveryLengthBrokenAnywhere) {
  std::mt19937 random(1);
  for (std::size_t length = 0; length < 40; ++length) {
    std::string bytes;
    for (std::size_t i = 0; i < length; ++i) bytes.push_back(static_cast<char>(random()));
    const std::string whole = GltfBuilder::base64(bytes);
    for (std::size_t at = 0; at <= whole.size(); ++at) {
      EXPECT_EQ(bytes_of("data:;base64," + std::string(whole).insert(at, "\r\n")), bytes) << length << " " << at;
      if (at == whole.size()) continue;
      char escaped[4];
      std::snprintf(escaped, sizeof(escaped), "%%%02X", whole[at]);
      EXPECT_EQ(bytes_of("data:;base64," + std::string(whole).replace(at, 1, escaped)), bytes) << length << " " << at;
    }
  }
}

TEST(Uri, DataThatAreWrongSaySo) {
  const std::pair<const char*, const char*> cases[] = {
      {"data:application/octet-stream;base64", "no comma"},
      {"data:application%2Foctet-stream%3Bbase64%2CAAAA", "no comma"},
      {"data:;base64,AAAA*AAA", "holds '*'"},
      {"data:;base64,AAAA%2AAAA", "holds '*'"},
      {"data:;base64,AAAA%ZZAA", "holds '%'"},
      {"data:;base64,AA\x80\x80", "holds byte 128"},
      {"data:;base64,AAAA%00AAA", "holds byte 0"},
      {"data:;base64,AA-_", "base64url"},
      {"data:;base64,AA==AA==", "after the padding"},
      {"data:;base64,=AAA", "after the padding"},
      {"data:;base64,AAAAA", "cut short"},
      {"data:;base64,A===", "cut short"},
      {"data:;base64;charset=utf-8,AAAA", "'base64' is not known, or not last"},
      {"data:;base64url,AAAA", "'base64url' is not known"},
      {"data:application/octet-stream;base32,AAAA", "'base32' is not known"},
      {"data:base64,AAAA", "'base64' is no media type"},
  };
  for (const auto& [uri, problem] : cases) EXPECT_NE(bytes_of(uri).find(problem), std::string::npos) << bytes_of(uri);
}

TEST(Uri, DataOfBuffersAndImages) {
  const GltfBuilder triangle = GltfBuilder::triangle();
  for (const char* head : {"data:application/octet-stream;BASE64,", "Data:;base64,", "data:a/b;c=d; base64 ,"}) {
    const Scene scene =
        load_gltf(TempFolder().write("a.gltf", triangle.json(head + GltfBuilder::base64(triangle.bytes))));
    EXPECT_EQ(scene.meshes.at(0).positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << head;
    GltfBuilder b = test::full();
    b.root["images"][0] = {{"uri", head + GltfBuilder::base64(std::string(test::kPng, sizeof(test::kPng) - 1))}};
    EXPECT_EQ(test::load(b).images.at(0).bytes, (std::vector<std::uint8_t>{64, 128, 192, 255})) << head;
  }
  // Percent-encoded bytes are as good; text is not, as base64 whose mark was forgotten.
  std::string escaped;
  for (const char c : triangle.bytes) {
    constexpr char kDigits[] = "0123456789abcdef";
    escaped += {'%', kDigits[static_cast<std::uint8_t>(c) >> 4], kDigits[c & 15]};
  }
  EXPECT_EQ(load_gltf(TempFolder().write("a.gltf", triangle.json("data:," + escaped))).meshes.at(0).positions[1].x,
            1.0f);
  const std::string forgotten = "data:application/octet-stream," + GltfBuilder::base64(triangle.bytes);
  EXPECT_THROW(load_gltf(TempFolder().write("a.gltf", triangle.json(forgotten))), Error);
}

TEST(Uri, DotSegmentsAreRemovedBeforeThePolicyAsks) {
  TempFolder folder;
  const auto home = folder.path() / "home";
  for (const char* name :
       {"t.png", "sub/t.png", "sub/deep/t.png", "..t.png", "...", "c:t.png", "a b.png", "a?b#1.png", "\xc3\xbc.png"})
    folder.write("home/" + std::string(name), "x");
  folder.write("x.png", "x");
  const std::pair<const char*, const char*> inside[] = {
      {"t.png", "t.png"},
      {"./t.png", "t.png"},
      {"sub/../t.png", "t.png"},
      {"absent/../t.png", "t.png"}, // what is removed need not be there
      {"sub/./deep/.././t.png", "sub/t.png"},
      {"sub/deep/../../t.png", "t.png"},
      {"././sub/../sub/deep/t.png", "sub/deep/t.png"},
      {"sub/%2e%2e/t.png", "t.png"}, // escaped dots are dots
      {"sub/.%2E/%2e/t.png", "t.png"},
      {"sub%2f..%2ft.png", "t.png"}, // escaped slashes part names here, as no name can hold one
      {"sub//deep///t.png", "sub/deep/t.png"},
      {"sub/..//t.png", "t.png"}, // not the root of the disk
      {"../home/t.png", "t.png"}, // out and in again, by name
      {"sub/../../home/sub/t.png", "sub/t.png"},
      {"..t.png", "..t.png"}, // not a dot segment
      {"...", "..."},
      {"./c:t.png", "c:t.png"}, // no scheme
      {"c%3At.png", "c:t.png"},
      {"a%20b.png", "a b.png"},
      {"a b.png", "a b.png"},
      {"%C3%BC.png", "\xc3\xbc.png"},
      {"\xc3\xbc.png", "\xc3\xbc.png"},
      {"sub\\t.png", "sub/t.png"}, // as Windows writes it
      {"sub\\..\\t.png", "t.png"},
      {".\\sub\\deep/../t.png", "sub/t.png"},
      {"sub/t.png?version=2", "sub/t.png"},
      {"t.png#1", "t.png"},
      {"a%3Fb%231.png", "a?b#1.png"},
      {"a?b#1.png", "a?b#1.png"}, // not encoded
  };
  for (const auto& [uri, file] : inside) {
    const auto path = resolve_uri(home, uri);
    ASSERT_TRUE(path) << uri;
    std::error_code error;
    EXPECT_TRUE(std::filesystem::equivalent(*path, home / file, error)) << uri << " is " << *path;
  }
  for (const std::string uri : {"../x.png",
                                "sub/../../x.png",
                                "sub/../../../x.png",
                                "sub/%2e%2e/%2E./x.png",
                                "..%2fx.png",
                                "..\\x.png",
                                "sub\\..\\..\\x.png",
                                "sub/..\\../x.png",
                                "../home2/t.png",
                                "../hom",
                                "../home/../x.png",
                                "/etc/passwd",
                                "//server/t.png",
                                "%2Fetc%2Fpasswd",
                                "\\etc\\passwd",
                                "%5C%5Cserver%5Ct.png",
                                "file:///etc/passwd",
                                "file:t.png",
                                "FILE:/etc/passwd",
                                "http://example.com/t.png",
                                "c:/t.png",
                                "C:\\t.png",
                                "c:t.png",
                                "",
                                "t.png%00",
                                "../x.png?a",
                                "?a/../../x.png",
                                ".."})
    EXPECT_FALSE(resolve_uri(home, uri)) << uri;
  // A way that is inside by name, whatever is there.
  EXPECT_EQ(resolve_uri(home, "sub/..//etc/passwd"), home / "etc/passwd");
  EXPECT_EQ(resolve_uri("", "sub/../t.png"), std::filesystem::path("t.png")); // beside a scene without a folder
}

// Removed by name, a link that leads elsewhere does not change what ".." means.
TEST(Uri, LinksAreFollowedButNotByDots) {
  TempFolder folder;
  folder.write("home/t.png", "inside");
  folder.write("t.png", "outside");
  folder.write("other/deep/t.png", "elsewhere");
  const auto home = folder.path() / "home";
  std::filesystem::create_directory_symlink(folder.path() / "other/deep", home / "link");
  EXPECT_EQ(resolve_uri(home, "link/../t.png"), home / "t.png");
  EXPECT_EQ(resolve_uri(home, "link/t.png"), home / "link/t.png");
  EXPECT_FALSE(resolve_uri(home, "link/../../t.png"));
}

} // namespace
} // namespace wavepath
