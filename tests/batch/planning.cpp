#include "item3d/batch/content_hash.h"
#include "item3d/batch/job_options.h"
#include "item3d/batch/plan_jobs.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "tests/batch/folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace item3d {
namespace {

class Planning : public item3d::testing::BatchTest {
  protected:
    void SetUp() override {
        BatchTest::SetUp();
        files_ = folder_ / "files";
        fs::create_directories(files_);
        for (const char* name : {"red-mug.glb", "tall_vase.glb"})
            write_atomically(files_ / name, std::string_view(name));
    }

    static JobPlanning planning() {
        JobCommand edit{"edit",
                        {{"from", ColumnKind::single},
                         {"to", ColumnKind::single},
                         {"seed", ColumnKind::single},
                         {"iterations", ColumnKind::single},
                         {"region", ColumnKind::repeated},
                         {"timesteps", ColumnKind::commas},
                         {"light", ColumnKind::single},
                         {"prior", ColumnKind::single},
                         {"plan", ColumnKind::single},
                         {"allow-missing-textures", ColumnKind::flag}},
                        {"from", "to"},
                        {"plan"}};
        JobCommand relight{"relight", {{"light", ColumnKind::single}}, {}, {}};
        return {{edit, relight},
                "1.0",
                [](const std::string& prior) { return "weights of " + prior; },
                [](const std::string&, const std::vector<std::string>& arguments) {
                    for (const std::string& argument : arguments)
                        if (argument == "wrong") throw UsageError("--seed: wrong");
                },
                {}};
    }

    std::vector<BatchJob> plan(const std::string& name, const std::string& text) const {
        write_atomically(files_ / name, std::string_view(text));
        return plan_jobs(read_job_rows(files_ / name), planning());
    }
    std::string refusal(const std::string& name, const std::string& text) const {
        try {
            plan(name, text);
        } catch (const Error& error) {
            return error.what();
        }
        return "accepted";
    }
    void expect_refused(const std::string& name, const std::string& text,
                        const std::string& part) const {
        const std::string why = refusal(name, text);
        EXPECT_NE(why.find(part), std::string::npos) << text << "\n" << why;
        EXPECT_EQ(why.find('\n'), std::string::npos) << why;
    }

    fs::path files_;
};

TEST_F(Planning, CsvListAndLinesSayTheSame) {
    const auto csv = plan("a.csv",
                          "model,from,to,iterations,region,allow_missing_textures\n"
                          "red-mug.glb,a red mug,\"a {name}, shining\",10,"
                          "\"[\"\"named=a\"\",\"\"named=b\"\"]\",true\n\n");
    const std::string object =
        R"({"model": "red-mug.glb", "from": "a red mug", "to": "a {name}, shining", "iterations": 10,
            "region": ["named=a", "named=b"], "allow-missing-textures": true, "seed": null})";
    std::string line = object;
    std::replace(line.begin(), line.end(), '\n', ' ');
    const auto list = plan("a.json", "[" + object + "]");
    const auto lines = plan("a.jsonl", "\n" + line + "\n");
    ASSERT_EQ(csv.size(), 1u);
    EXPECT_EQ(csv[0].to, "a red mug, shining");
    EXPECT_EQ(csv[0].arguments,
              (std::vector<std::string>{"--allow-missing-textures", "--from", "a red mug",
                                        "--iterations", "10", "--region", "named=a", "--region",
                                        "named=b", "--to", "a red mug, shining"}));
    EXPECT_EQ(csv[0].model, (files_ / "red-mug.glb").string());
    for (const auto& other : {list, lines}) {
        ASSERT_EQ(other.size(), 1u);
        EXPECT_EQ(other[0].id, csv[0].id);
        EXPECT_EQ(other[0].key, csv[0].key);
        EXPECT_EQ(other[0].folder, csv[0].folder);
    }
    EXPECT_EQ(csv[0].folder.find("runs/" + csv[0].id.substr(0, 2) + "/red-mug-a-red-mug-shining-"),
              0u)
        << csv[0].folder;
    EXPECT_EQ(nlohmann::json(csv[0]).get<BatchJob>().arguments, csv[0].arguments);
}

TEST_F(Planning, TheIdentityIsOfAllThatDecidesTheResult) {
    const auto id = [&](const std::string& rest) {
        return plan("a.jsonl",
                    R"({"model": "red-mug.glb", "from": "a", "to": "b")" + rest + "}")[0];
    };
    const BatchJob first = id("");
    EXPECT_EQ(id("").id, first.id);
    std::set<std::string> ids = {first.id};
    write_atomically(files_ / "sky.hdr", std::string_view("sky"));
    for (const char* rest : {R"(, "seed": 1)", R"(, "seed": 2)", R"(, "prior": "sd")",
                             R"(, "light": "sky.hdr")", R"(, "light": "studio")"})
        EXPECT_TRUE(ids.insert(id(rest).id).second) << rest;
    // The contents of files count, not their paths.
    const std::string sky = id(R"(, "light": "sky.hdr")").id;
    fs::rename(files_ / "sky.hdr", files_ / "sky2.hdr");
    EXPECT_EQ(id(R"(, "light": "sky2.hdr")").id, sky);
    EXPECT_EQ(id(R"(, "light": "sky2.hdr")").arguments[3], (files_ / "sky2.hdr").string());
    write_atomically(files_ / "sky2.hdr", std::string_view("night"));
    EXPECT_NE(id(R"(, "light": "sky2.hdr")").id, sky);
    write_atomically(files_ / "red-mug.glb", std::string_view("changed"));
    const BatchJob changed = id("");
    EXPECT_NE(changed.id, first.id);
    EXPECT_EQ(changed.key, first.key) << "it takes the first one's place";
    fs::remove(files_ / "red-mug.glb");
    EXPECT_EQ(id("").model_hash, "") << "a model that is missing fails its job alone";
    // A named job keeps its key under any change.
    EXPECT_EQ(id(R"(, "name": "x", "seed": 1)").key, id(R"(, "name": "x", "seed": 2)").key);
}

TEST_F(Planning, FilesThatAModelNamesCount) {
    write_atomically(files_ / "a.gltf", std::string_view(R"({"buffers": [{"uri": "a%20b.bin"}]})"));
    write_atomically(files_ / "a b.bin", std::string_view("1"));
    write_atomically(files_ / "a.obj", std::string_view("mtllib a.mtl\n"));
    write_atomically(files_ / "a.mtl", std::string_view("newmtl m\nmap_Kd -s 1 1 1 a.png\n"));
    write_atomically(files_ / "a.png", std::string_view("1"));
    const std::string gltf = ContentHashes().of_model(files_ / "a.gltf");
    const std::string obj = ContentHashes().of_model(files_ / "a.obj");
    write_atomically(files_ / "a b.bin", std::string_view("2"));
    write_atomically(files_ / "a.png", std::string_view("2"));
    EXPECT_NE(ContentHashes().of_model(files_ / "a.gltf"), gltf);
    EXPECT_NE(ContentHashes().of_model(files_ / "a.obj"), obj);
    EXPECT_EQ(ContentHashes().of_model(files_ / "none.obj"), "");
    EXPECT_EQ(ContentHashes().of_model(files_), "");  // the job itself refuses a folder
}

TEST_F(Planning, PathsWithinValuesBecomeAbsolute) {
    write_atomically(files_ / "a.safetensors", std::string_view("1"));
    const std::string path = (files_ / "a.safetensors").string();
    EXPECT_EQ(with_absolute_path("lora", "a.safetensors", files_), path);
    EXPECT_EQ(with_absolute_path("lora", "a.safetensors:0.5", files_), path + ":0.5");
    EXPECT_EQ(with_absolute_path("region", "mask=a.safetensors", files_), "mask=" + path);
    EXPECT_EQ(with_absolute_path("light", "studio", files_), "studio");
    EXPECT_EQ(with_absolute_path("to", "a.safetensors", files_), "a.safetensors");
}

TEST_F(Planning, JobsComeAfterTheirPredecessors) {
    const auto jobs = plan("a.csv",
                           "name,model,after,from,to\n"
                           "third,,second,a {name},b\n"
                           "second,,first,a,b\n"
                           "first,red-mug.glb,,a,b\n");
    ASSERT_EQ(jobs.size(), 3u);
    EXPECT_EQ(jobs[0].name, "first");
    EXPECT_EQ(jobs[1].after, jobs[0].id);
    EXPECT_EQ(jobs[2].after, jobs[1].id);
    EXPECT_EQ(jobs[2].from, "a red mug");
    expect_refused("a.csv", "name,after,from,to\na,c,x,y\nb,a,x,y\nc,b,x,y\n",
                   "form a cycle: a after c after b after a");
    expect_refused("a.csv", "name,after,from,to\na,a,x,y\n", "form a cycle: a after a");
    expect_refused("a.csv", "name,after,from,to\na,none,x,y\n", "its `after` is 'none'");
    JobPlanning known = planning();
    known.known_names["earlier"] = "0123";
    write_atomically(files_ / "b.csv", std::string_view("after,from,to\nearlier,a,b\n"));
    EXPECT_EQ(plan_jobs(read_job_rows(files_ / "b.csv"), known)[0].after, "0123");
}

TEST_F(Planning, WhatIsWrongIsNamed) {
    const std::string row = "red-mug.glb,a,b,";
    expect_refused("a.csv", "model,from,to,iteratons\n" + row + "1\n", "did you mean 'iterations'");
    expect_refused("a.csv", "model,from,to,output\n" + row + "out\n", "is set by the batch");
    expect_refused("a.csv", "model;from;to\nm.glb;a mug;a cup\n", "separate columns by commas");
    expect_refused("a.csv", "model,from,to,sead\n" + row + "1\n", "row 2: unknown column");
    expect_refused("a.csv", "model,from,to,seed\n" + row + "wrong\n", "row 2: --seed: wrong");
    expect_refused("a.csv", "model,from,to,seed\n" + row + "1,2\n",
                   "5 fields, but the header has 4");
    expect_refused("a.csv", "model,from,to\nred-mug.glb,a,\n", "has no 'to'");
    expect_refused("a.csv", "from,to\na,b\n", "has no model");
    expect_refused("a.csv", "model,after,from,to\nx.glb,y,a,b\n", "model and after");
    expect_refused("a.csv", "model,from,to,command\n" + row + "paint\n", "edit or relight");
    expect_refused("a.csv", "model,command,iterations\nred-mug.glb,relight,1\n",
                   "unknown column 'iterations'");
    expect_refused("a.csv", "name,model,from,to\nx," + row + "\n", "5 fields");
    expect_refused("a.csv", "name,model,from,to\nx,m.glb,a,b\nx,m.glb,a,c\n", "the name 'x'");
    expect_refused("a.csv", "model,from,to\n", "contains no jobs");
    expect_refused("a.csv", "", "contains no jobs");
    expect_refused("a.json", "[", "is not valid JSON");
    expect_refused("a.jsonl", "{\"model\": \"m.glb\"}\nnonsense\n", "line 2: is not valid JSON");
    expect_refused("a.jsonl", "3\n", "expected an object");
    expect_refused("a.jsonl", R"({"model": "m.glb", "from": "a", "to": "b", "seed": {"x": 1}})",
                   "seed cannot be");
    expect_refused("a.csv", "model,from,to,allow-missing-textures\n" + row + "perhaps\n",
                   "expected true or false");
}

TEST_F(Planning, AMatrixIsEveryCombination) {
    JobMatrix matrix{{(files_ / "*.glb").string()}, {"a {name}"}, {"a golden {name}", "b"}};
    const auto rows = with_values(matrix_rows(matrix), {"seed=0", "seed=1", "iterations=3"});
    ASSERT_EQ(rows.size(), 8u);
    const auto jobs = plan_jobs(rows, planning());
    std::set<std::string> ids;
    for (const BatchJob& job : jobs)
        ids.insert(job.id);
    EXPECT_EQ(ids.size(), 8u);
    EXPECT_EQ(jobs[4].to, "a golden tall vase");
    EXPECT_THROW(matrix_rows({{"none*.glb"}, {"a"}, {"b"}}), InputError);
    EXPECT_THROW(matrix_rows({{"a.glb"}, {"a", "b"}, {"b"}}), UsageError);
    EXPECT_THROW(with_values(rows, {"seed"}), UsageError);
    JobRow named = rows[0];
    named.values["name"] = "x";
    EXPECT_THROW(with_values({named}, {"seed=0", "seed=1"}), UsageError);
    EXPECT_EQ(with_values({named}, {"seed=5"})[0].values["seed"], "5");
}

}  // namespace
}  // namespace item3d
