// Tests of claims in XMP, JSON-LD and signatures. Claims are read as they were written, and other
// data stays.
#include "item3d/core/date.h"
#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/provenance/claim.h"
#include "item3d/provenance/json_ld.h"
#include "item3d/provenance/signing.h"
#include "item3d/provenance/xmp.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace item3d {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

EditClaim golden_edit() {
    EditClaim edit;
    edit.from = "a red mug";
    edit.to = "a <golden> & \"old\" m\xc3\xbcg";
    edit.prior = "embedded";
    edit.prior_hash = "0123456789abcdef";
    edit.date = "2026-11-27T15:04:05Z";
    return edit;
}

json golden_claim() {
    return make_claim({golden_edit()}, {{"2", "paint", "ab"}, {"3", "", "cd"}}, "ef");
}

TEST(Claim, IsReadFromXmpAndJsonLdAsItWasWritten) {
    const json claim = golden_claim();
    const PacketMetadata xmp = read_xmp(xmp_with_claim("", claim));
    EXPECT_EQ(xmp.problem, "");
    EXPECT_EQ(xmp.claim, claim);
    EXPECT_TRUE(xmp.source_type.ends_with("/compositeWithTrainedAlgorithmicMedia"));
    ordered_json packet{{"@context", ordered_json::object()}};
    put_claim(packet, claim);
    const PacketMetadata json_ld = read_json_ld(ordered_json::parse(packet.dump()));
    EXPECT_EQ(json_ld.claim, claim);
    EXPECT_EQ(json_ld.source_type, xmp.source_type);
    EXPECT_EQ(edits_of(json_ld.claim), std::vector{golden_edit()});
    EXPECT_EQ(images_of(json_ld.claim).at(1), (ImageClaim{"3", "", "cd"}));
    remove_claim(packet);
    EXPECT_TRUE(read_json_ld(packet).claim.is_null());
    EXPECT_FALSE(read_json_ld(packet).source_type.empty());
}

TEST(Claim, AReconstructionIsACaptureUntilItIsEdited) {
    EditClaim capture;
    capture.photographs = "98";
    capture.source_type = "http://cv.iptc.org/newscodes/digitalsourcetype/computationalCapture";
    const std::string packet = xmp_with_claim("", make_claim({capture}, {}));
    const PacketMetadata metadata = read_xmp(packet);
    EXPECT_EQ(metadata.source_type, capture.source_type);
    EXPECT_EQ(edits_of(metadata.claim), std::vector{capture});
    EXPECT_EQ(packet.find("AISystem"), std::string::npos);
    EXPECT_EQ(packet.find("rainedAlgorithmic"), std::string::npos);
    const std::string edited = xmp_with_claim(packet, make_claim({capture, golden_edit()}, {}));
    EXPECT_TRUE(read_xmp(edited).source_type.ends_with("/compositeWithTrainedAlgorithmicMedia"));
    EXPECT_NE(edited.find("AISystemUsed"), std::string::npos);
    EXPECT_EQ(edits_of(read_xmp(edited).claim).size(), 2u);
}

TEST(Claim, HoldsAnySentence) {
    EditClaim edit;
    edit.from = "\xff\xfe mug\r\n\x01 \xef\xbf\xbf";
    edit.to = "  ";
    const json claim = make_claim({edit, edit}, {});
    EXPECT_EQ(read_xmp(xmp_with_claim("", claim)).claim, claim);
    EXPECT_EQ(join_edits({}, {edit, edit}).size(), 1u);
    EXPECT_EQ(edits_of(claim).at(0).to, "");
}

TEST(Claim, EditsAreJoinedOnceAndDatedByTheLast) {
    EditClaim later = golden_edit();
    later.date = "2027-01-01T00:00:00Z";
    const auto edits = join_edits({golden_edit()}, {golden_edit(), later});
    ASSERT_EQ(edits.size(), 2u);
    EXPECT_EQ(date_of(edits), later.date);
}

constexpr const char* foreign_packet = R"(<?xpacket begin="" id="W5M0MpCehiHzreSzNTczkc9d"?>
<x:xmpmeta xmlns:x="adobe:ns:meta/"><r:RDF xmlns:r="http://www.w3.org/1999/02/22-rdf-syntax-ns#">
<r:Description r:about="uuid:7" xmlns:d="http://purl.org/dc/elements/1.1/"
  xmlns:x1="http://iptc.org/std/Iptc4xmpExt/2008-02-29/" xmlns:o="urn:other#"
  x1:DigitalSourceType="http://cv.iptc.org/newscodes/digitalsourcetype/digitalCapture" o:kept="yes">
<d:creator><r:Seq><r:li>Ada</r:li><r:li>Ben</r:li></r:Seq></d:creator>
<d:rights><r:Alt><r:li xml:lang="x-default">CC BY 4.0</r:li></r:Alt></d:rights>
</r:Description></r:RDF></x:xmpmeta><?xpacket end="w"?>)";

TEST(Xmp, WhatOthersWroteStays) {
    const std::string once = xmp_with_claim(foreign_packet, golden_claim());
    const PacketMetadata metadata = read_xmp(once);
    EXPECT_EQ(metadata.claim, golden_claim());
    EXPECT_EQ(metadata.creator, "Ada; Ben");
    EXPECT_EQ(metadata.rights, "CC BY 4.0");
    EXPECT_TRUE(metadata.source_type.ends_with("compositeWithTrainedAlgorithmicMedia"));
    EXPECT_EQ(once.find("digitalCapture"), std::string::npos);
    EXPECT_NE(once.find("o:kept=\"yes\""), std::string::npos);
    EXPECT_NE(once.find("rdf:about=\"uuid:7\""), std::string::npos);
    const json other = make_claim({}, {});
    const std::string twice = xmp_with_claim(once, other);
    EXPECT_EQ(read_xmp(twice).claim, other);
    EXPECT_EQ(twice.find("golden"), std::string::npos);
    EXPECT_EQ(read_xmp(twice).creator, "Ada; Ben");
}

TEST(Xmp, BrokenPacketsAreToldAndReplaced) {
    std::string deep = "<x:xmpmeta xmlns:x='adobe:ns:meta/'>";
    for (int i = 0; i < 100000; ++i)
        deep += "<a>";
    for (int i = 0; i < 100000; ++i)
        deep += "</a>";
    deep += "</x:xmpmeta>";
    const std::string cut = std::string(foreign_packet).substr(0, 500);
    for (const std::string& packet :
         {std::string("no xml"), std::string("<a"), cut, deep, std::string("<a/>"),
          std::string(largest_packet + 1, ' '), std::string("\0\xff\xfe<", 4)}) {
        EXPECT_NE(read_xmp(packet).problem, "") << packet.substr(0, 60);
        EXPECT_EQ(read_xmp(xmp_with_claim(packet, golden_claim())).claim, golden_claim());
    }
    std::string latin = foreign_packet;
    latin.replace(latin.find("Ada"), 3, "Ad\xe9");
    EXPECT_EQ(read_xmp(latin).creator, "Ad\xef\xbf\xbd; Ben");
}

TEST(Xmp, ByteChangesNeverBreakTheReader) {
    const std::string packet = xmp_with_claim(foreign_packet, golden_claim());
    int readable = 0;
    for (std::size_t i = 0; i < packet.size(); i += 3) {
        std::string changed = packet;
        changed[i] = static_cast<char>(changed[i] ^ (1 << i % 8));
        const PacketMetadata metadata = read_xmp(changed);
        if (metadata.problem.empty()) ++readable;
        EXPECT_EQ(read_xmp(xmp_with_claim(changed, golden_claim())).claim, golden_claim()) << i;
        signature_state(metadata.claim);
        edits_of(metadata.claim);
    }
    EXPECT_GT(readable, 100);
}

TEST(JsonLd, PrefixesOfOthersAreKept) {
    ordered_json packet = ordered_json::parse(R"({
        "@context": {"item3d": "urn:other#", "d": "http://purl.org/dc/elements/1.1/", "n": 3},
        "item3d:claim": "theirs", "d:creator": {"@list": ["Ada", 7, "Ben"]},
        "d:rights": {"@type": "rdf:Alt", "rdf:_1": {"@language": "en", "@value": "CC BY 4.0"}}})");
    put_claim(packet, golden_claim());
    EXPECT_EQ(packet["item3d:claim"], "theirs");
    const PacketMetadata metadata = read_json_ld(packet);
    EXPECT_EQ(metadata.claim, golden_claim());
    EXPECT_EQ(metadata.creator, "Ada; Ben");
    EXPECT_EQ(metadata.rights, "CC BY 4.0");
    for (const char* broken : {"3", "[]", "{}", R"({"@context": "https://example.org"})"})
        EXPECT_NE(read_json_ld(ordered_json::parse(broken)).problem, "") << broken;
    packet["item3d2:claim"] = ordered_json::parse(R"({"item3d2:edits": {"@list": 3},
        "item3d2:program": 7})");
    EXPECT_TRUE(edits_of(read_json_ld(packet).claim).empty());
}

class SigningTest : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("item3d_signing_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path file(const char* name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return folder_ / name;
    }
    std::string problem_of(const std::string& pem) const {
        try {
            SigningKey::load(file("wrong.pem", pem));
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }
    std::filesystem::path folder_;
};

// The key pair of RFC 8032, 7.1, test 1.
constexpr const char* private_pem =
    "-----BEGIN PRIVATE KEY-----\n"
    "MC4CAQAwBQYDK2VwBCIEIJ1hsZ3v/VpguoRK9JLsLMREScVpezJpGXA7rAMcrn9g\n"
    "-----END PRIVATE KEY-----\n";
constexpr const char* public_pem =
    "-----BEGIN PUBLIC KEY-----\n"
    "MCowBQYDK2VwAyEA11qYAYKxCrfVS/7TyWQHOg7hcvPapiMlrwIaaPcHURo=\n"
    "-----END PUBLIC KEY-----\n";

TEST_F(SigningTest, SignsWhatCannotBeChangedUnseen) {
    const SigningKey key = SigningKey::load(file("key.pem", private_pem));
    json claim = golden_claim();
    EXPECT_EQ(signature_state(claim), SignatureState::none);
    key.sign(claim);
    EXPECT_EQ(signature_state(claim), SignatureState::valid);
    EXPECT_EQ(public_key_of(claim), load_public_key(file("public.pem", public_pem)));
    EXPECT_THROW(load_public_key(file("key.pem", private_pem)), InputError);
    EXPECT_EQ(signature_state(read_xmp(xmp_with_claim("", claim)).claim), SignatureState::valid);
    json again = golden_claim();
    key.sign(again);
    EXPECT_EQ(again, claim);
    for (const char* pointer :
         {"/edits/0/to", "/images/1/sha256", "/document_sha256", "/version"}) {
        json changed = claim;
        changed[json::json_pointer(pointer)] = "x";
        EXPECT_EQ(signature_state(changed), SignatureState::invalid) << pointer;
    }
    json more = claim;
    more["unknown"] = "x";
    EXPECT_EQ(signature_state(more), SignatureState::invalid);
    for (const char* member : {"signature", "public_key"}) {
        for (const char* wrong : {"x", "====", "AAAA"}) {
            json changed = claim;
            changed[member] = wrong;
            EXPECT_EQ(signature_state(changed), SignatureState::invalid) << member << wrong;
        }
    }
}

TEST_F(SigningTest, WrongKeysAreToldInOneLine) {
    EXPECT_NE(problem_of("").find("is not a PEM key"), std::string::npos);
    EXPECT_NE(problem_of(public_pem).find("is a public key"), std::string::npos);
    EXPECT_NE(problem_of(std::string(private_pem).replace(40, 4, "!!!!")).find("damaged"),
              std::string::npos);
    EXPECT_NE(problem_of("-----BEGIN ENCRYPTED PRIVATE KEY-----\n").find("password"),
              std::string::npos);
    // The key is for X25519 instead of Ed25519.
    std::string other = private_pem;
    other.replace(other.find("BQYDK2Vw"), 8, "BQYDK2Vu");
    EXPECT_NE(problem_of(other).find("X25519"), std::string::npos) << problem_of(other);
    EXPECT_THROW(SigningKey::load(folder_ / "missing.pem"), InputError);
    EXPECT_THROW(load_public_key(file("text.pem", "hello")), InputError);
}

TEST(Date, HonoursSourceDateEpoch) {
    const char* before = std::getenv("SOURCE_DATE_EPOCH");
    const std::string kept = before ? before : "";
    setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
    EXPECT_EQ(utc_date(), "2023-11-14T22:13:20Z");
    for (const char* wrong : {"", "x", "-1", "1e9", "99999999999999"}) {
        setenv("SOURCE_DATE_EPOCH", wrong, 1);
        EXPECT_THROW(utc_date(), InputError) << wrong;
    }
    unsetenv("SOURCE_DATE_EPOCH");
    EXPECT_EQ(utc_date().size(), 20u);
    if (before) setenv("SOURCE_DATE_EPOCH", kept.c_str(), 1);
}

TEST(Digest, IsSha256) {
    EXPECT_EQ(sha256(std::string_view("abc")),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace item3d
