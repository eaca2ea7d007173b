// Tests of the program's messages, their streams, and exit codes.
#include "tests/support/program.h"

#include <sys/stat.h>

namespace item3d::testing {
namespace {

TEST_F(Program, HelpAndVersionGoToStdout) {
    const Result help = run("--help");
    EXPECT_EQ(help.code, 0);
    for (const char* command :
         {"edit", "render", "generate", "caption", "score", "prior", "bench"}) {
        EXPECT_NE(help.out.find(command), std::string::npos) << command;
        EXPECT_EQ(run(std::string(command) + " --help").code, 0) << command;
    }
    const Result version = run("--version");
    EXPECT_EQ(version.code, 0);
    EXPECT_EQ(version.out.rfind("item3d ", 0), 0u) << version.out;
}

TEST_F(Program, GuidanceHelpListsTheMethods) {
    const Result help = run("edit --guidance help");
    EXPECT_EQ(help.code, 0);
    for (const char* method : {"rdl", "sds", "dds", "pds", "nfsd", "csd", "ism", "sdi"})
        EXPECT_NE(help.out.find(std::string("\n") + method + " "), std::string::npos) << method;
    EXPECT_EQ(help.error, "");
}

TEST_F(Program, MethodHelpListsThem) {
    const Result help = run("edit --method help");
    EXPECT_EQ(help.code, 0);
    for (const char* method :
         {"item3d", "sds", "controlnet-2d", "texture", "text2tex", "syncmvd", "in2n", "clip"})
        EXPECT_NE(help.out.find(std::string("\n") + method + " "), std::string::npos) << method;
    const std::string edit =
        "edit " + quoted(cube_) + " --from a --to b -o " + quoted(folder_ / "out") + " --method ";
    EXPECT_EQ(run(edit + "magic").code, 3);
    EXPECT_EQ(run(edit + "texture --guidance sds").code, 2);
    EXPECT_EQ(run(edit + "texture --optimize light").code, 2);
    EXPECT_EQ(run(edit + "texture --clip-loss absolute").code, 2);
    // This prior follows no instructions, and no InstructPix2Pix is given.
    EXPECT_EQ(run(edit + "in2n --prior '" ITEM3D_TEST_DATA "/models/pipeline_sd'").code, 3);
}

TEST_F(Program, WrongUsageIsTwo) {
    EXPECT_EQ(run("").code, 2);
    EXPECT_EQ(run("no_such_command").code, 2);
    expect_error("render", 2, "`item3d render --help`");
    expect_error("render a.glb -o b.png --no-such-option", 2, "--no-such-option");
    expect_error("render a.glb -o b.png --threads 0", 2, "--threads");
    expect_error("render a.glb -o b.png --device tpu", 2, "--device");
    expect_error("edit a.glb -o b --cfg much", 2, "much");
    EXPECT_EQ(
        run("render " + quoted(cube_) + " -o " + quoted(folder_ / "b.png") + " --size 0x0").code,
        2);
}

TEST_F(Program, WhatCannotBeReadIsThreeAndNamed) {
    const std::string to = " -o " + quoted(folder_ / "picture.png");
    expect_error("render /nowhere/model.glb" + to, 3, "/nowhere/model.glb");
    expect_error("render " + quoted(folder_) + to, 3, folder_.string());
    expect_error("render " + quoted(cube_) + to + " --light /nowhere.hdr", 3, "/nowhere.hdr");
    expect_error("render " + quoted(cube_) + to + " --cameras /nowhere.json", 3, "/nowhere.json");
    const std::string too_long(300, 'n');  // a file name has at most 255 bytes
    expect_error("study serve " + too_long, 3, "File name too long; check the path");
    const fs::path pipe = folder_ / "pipe.glb";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    for (const std::string& command :
         {"render " + quoted(pipe) + to, "light " + quoted(pipe) + to, "provenance " + quoted(pipe),
          "render " + quoted(cube_) + to + " --cameras " + quoted(pipe)})
        expect_error(command, 3, "is not a regular file");
    std::ofstream(folder_ / "empty.glb").flush();
    expect_error("render " + quoted(folder_ / "empty.glb") + to, 3, "empty.glb");
    EXPECT_FALSE(fs::exists(folder_ / "picture.png"));
}

TEST_F(Program, WhatCannotBeWrittenIsNamed) {
    expect_error("render " + quoted(cube_) + " -o " + quoted(cube_ / "below" / "p.png"), 3,
                 "below");
    // A limit on file sizes (4 KiB, blocks of 512 bytes) simulates a full disk.
    expect_error("render " + quoted(cube_) + " --size 512x512 --background red -o " +
                     quoted(folder_ / "full.exr"),
                 4, "full.exr", "ulimit -f 8; ");
    EXPECT_FALSE(fs::exists(folder_ / "full.exr"));
}

TEST_F(Program, NothingIsReplacedByMistake) {
    const std::string render = "render " + quoted(cube_) + " --size 16x16 -o ";
    const std::string before = read_file(cube_);
    expect_error(render + quoted(folder_ / "p.png") + " --progress-file " + quoted(cube_), 3,
                 "is not a progress file");
    EXPECT_EQ(read_file(cube_), before);
    const fs::path progress = folder_ / "progress.json", pipe = folder_ / "pipe.png";
    for (int twice = 0; twice < 2; ++twice)
        EXPECT_EQ(
            run(render + quoted(folder_ / "p.png") + " --progress-file " + quoted(progress)).code,
            0);
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    expect_error(render + quoted(pipe), 3, "is a device or a pipe");
    expect_error(render + quoted(folder_ / "p.png") + " --progress-file " + quoted(pipe), 3,
                 "is a device or a pipe");
    EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST_F(EditProgram, TheInputIsNotOverwritten) {
    const fs::path own = folder_ / "own";
    fs::create_directories(own / "textures");
    const auto edit_of = [&](const fs::path& model) {
        return "edit " + quoted(model) + " --prior '" + prior() + "' ";
    };
    std::ofstream(own / "model.glb") << "the user's model";
    std::ofstream(folder_ / "plan.json")
        << R"({"edits": [{"from": "a red quad", "to": "a blue quad"}]})";
    expect_error(edit_of(own / "model.glb") + to("own"), 3, "would be overwritten");
    expect_error(edit_of(own / "model.glb") + "--plan " + quoted(folder_ / "plan.json") + " -o " +
                     quoted(own),
                 3, "would be overwritten");
    expect_error("relight " + quoted(own / "model.glb") + " --light noon -o " + quoted(own), 3,
                 "would be overwritten");
    fs::create_symlink(cube_, own / "link.obj");
    expect_error(edit_of(own / "link.obj") + to("own"), 3, "own/textures");
    expect_error(edit_of(cube_) + to("own") + " --textures " + quoted(own), 3, "own/textures");
    std::ofstream(own / "textures" / "paint.png") << "the user's texture";
    std::ofstream(folder_ / "named.gltf")
        << R"({"asset": {"version": "2.0"}, "images": [{"uri": "own\\textures\\paint.png"}]})";
    expect_error(edit_of(folder_ / "named.gltf") + to("own"), 3, "own/textures");
    EXPECT_EQ(read_file(own / "model.glb"), "the user's model");
}

TEST_F(Program, ResultsThatCannotBePrintedAreFour) {
    const std::string draw = "render " + quoted(cube_) + " --quiet --size 32x32" + small_light();
    const std::string path = (folder_ / "p.png").string();
    expect_error(draw + "-o " + quoted(path), 4, "stdout", "sh -c '\"$@\" >/dev/full' sh ");
    EXPECT_EQ(read_file(path).substr(1, 3), "PNG");
    // If stdout is closed, the next file that is opened gets its descriptor.
    expect_error(draw + "-o " + quoted(path), 4, "stdout", "sh -c '\"$@\" >&-' sh ");
    EXPECT_EQ(read_file(path).find(path), std::string::npos);
}

TEST_F(Program, ALogThatIsFullOrClosedEndsNothing) {
    const std::string draw = "render " + quoted(cube_) + " --size 32x32 --views 2" + small_light();
    for (const char* log : {"2>/dev/full", "2>&-"}) {
        const fs::path to = folder_ / "views";
        const Result result =
            run(draw + "-o " + quoted(to), std::string("sh -c '\"$@\" ") + log + "' sh ");
        EXPECT_EQ(result.code, 0) << log;
        EXPECT_EQ(std::distance(fs::directory_iterator(to), fs::directory_iterator()), 2) << log;
        fs::remove_all(to);
    }
    EXPECT_EQ(run("render " + quoted(folder_ / "none.glb") + " -o p.png",
                  "sh -c '\"$@\" 2>/dev/full' sh ")
                  .code,
              3);
}

TEST_F(Program, ADeviceThatIsNotThereIsFour) {
    // CUDA hides all devices from this run, on any machine.
    const std::string hidden = "CUDA_VISIBLE_DEVICES= ";
    const std::string to = " --device cuda -o " + quoted(folder_ / "out");
    expect_error("render " + quoted(cube_) + to, 4, "--device cuda", hidden);
    expect_error("edit " + quoted(cube_) + " --from 'a grey cube' --to 'a red cube'" + to, 4,
                 "--device cuda", hidden);
    EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(Program, QuietIsQuiet) {
    const Result result =
        run("render " + quoted(cube_) + " --quiet --size 32x32 -o " + quoted(folder_ / "p.png"));
    EXPECT_EQ(result.code, 0) << result.error;
    EXPECT_EQ(result.error, "");
    EXPECT_TRUE(fs::exists(folder_ / "p.png"));
}

TEST_F(Program, JsonIsOneObjectOnStdout) {
    const Result result =
        run("render " + quoted(cube_) + " --json --size 32x32 -o " + quoted(folder_ / "p.png"));
    EXPECT_EQ(result.code, 0) << result.error;
    EXPECT_EQ(result.out.front(), '{') << result.out;
    EXPECT_EQ(result.out.substr(result.out.size() - 2), "}\n") << result.out;
}

// Malformed models and images of all kinds are refused (code 3) or read with a warning (code 0), in
// seconds.
TEST_F(Program, MalformedFilesAreRefusedOrWarnedAbout) {
    const fs::path bad = fs::path(ITEM3D_TEST_DATA) / "scene" / "bad";
    const std::string to = " --quiet --size 16x16 -o " + quoted(folder_ / "bad.png");
    int count = 0;
    for (const auto& entry : fs::directory_iterator(bad)) {
        const std::string extension = entry.path().extension().string();
        std::string arguments;
        if (extension == ".glb" || extension == ".gltf" || extension == ".obj") {
            arguments = "render " + quoted(entry.path()) + to + small_light();
        } else if (extension == ".hdr" || extension == ".exr" || extension == ".png") {
            arguments = "render " + quoted(cube_) + to + " --light " + quoted(entry.path());
        } else {
            continue;
        }
        const Result result = run(arguments);
        EXPECT_TRUE(result.code == 0 || result.code == 3)
            << entry.path().filename() << ": " << result.code << "\n"
            << result.error;
        EXPECT_FALSE(result.code == 3 && result.error.empty()) << entry.path().filename();
        ++count;
    }
    EXPECT_GE(count, 20);
}

TEST_F(EditProgram, WhatItCannotUseIsThreeAndNothingIsLeft) {
    expect_error(edit("--from '' --to 'a blue cube' -o " + quoted(folder_ / "out")), 3, "--from");
    expect_error(edit("--from 'a red cube' --to ' ' -o " + quoted(folder_ / "out")), 3, "--to");
    expect_error(edit(to("cube.obj/out")), 3, "out");
    expect_error(edit(to("out") + " --material glass"), 3, "glass");
    expect_error(edit(to("out") + " --keep everything"), 3, "--keep");
    expect_error(edit(to("out") + " --light /nowhere.hdr"), 3, "/nowhere.hdr");
    expect_error("generate ' ' -o " + quoted(folder_ / "p.png"), 3, "PROMPT");
    std::ofstream(folder_ / "points.obj") << "v 0 0 0\nv 1 0 0\n";
    std::ofstream(folder_ / "nan.obj") << "v 0 nan 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
    for (const char* name : {"points.obj", "nan.obj", "missing.obj"}) {
        expect_error("edit " + quoted(folder_ / name) + " --prior '" + prior() + "'" + to("out"), 3,
                     name);
    }
    EXPECT_FALSE(fs::exists(folder_ / "out" / "model.glb"));
}

TEST_F(EditProgram, WhatIsAddedToThePriorIsNamedWhereItCannotBeUsed) {
    expect_error(edit(to("out") + " --lora /nowhere.safetensors:0.5"), 3, "/nowhere.safetensors");
    std::ofstream(folder_ / "word.pt") << "PK";
    expect_error(edit(to("out") + " --embedding " + quoted(folder_ / "word.pt")), 3, "pickle");
    expect_error(edit(to("out") + " --controlnet '" ITEM3D_TEST_DATA "/models/vae_tiny'"), 3,
                 "ControlNetModel");
    const std::string draw = "generate 'a duck' --steps 1 --size 32 -o " +
                             quoted(folder_ / "p.png") + " --prior '" + prior() +
                             "' --controlnet '" ITEM3D_TEST_DATA "/models/controlnet_depth'";
    expect_error(draw, 3, "--like");
    const Result drawn = run(draw + " --vae '" ITEM3D_TEST_DATA "/models/vae_tiny' --like " +
                             quoted(cube_) + " --json");
    EXPECT_EQ(drawn.code, 0) << drawn.error;
    EXPECT_NE(drawn.out.find("vae_tiny"), std::string::npos) << drawn.out;
}

TEST_F(EditProgram, BrokenPriorsAreThreeAndNamed) {
    expect_error(edit(to("out"), "/nowhere/prior"), 3, "/nowhere/prior");

    const fs::path cut = copy_of_prior("cut");
    const fs::path weights = cut / "unet" / "diffusion_pytorch_model.safetensors";
    fs::resize_file(weights, fs::file_size(weights) / 2);
    expect_error(edit(to("out"), cut.string()), 3, "diffusion_pytorch_model.safetensors");

    const fs::path odd = copy_of_prior("odd");
    const fs::path config = odd / "unet" / "config.json";
    std::string text = read_file(config);
    const std::size_t at = text.find("\"cross_attention_dim\": ");
    ASSERT_NE(at, std::string::npos);
    text.insert(text.find(':', at) + 2, "1");
    std::ofstream(config) << text;
    expect_error(edit(to("out"), odd.string()), 3, "unet");

    const fs::path lost = copy_of_prior("lost");
    fs::remove(lost / "vae" / "config.json");
    expect_error(edit(to("out"), lost.string()), 3, "vae");
}

TEST_F(EditProgram, FullDiskIsFourAndLeavesNoHalfModel) {
    // Each file may have 64 KiB, which is too little for the checkpoint. The checkpoint is the
    // first file.
    expect_error(edit(to("out")), 4, "checkpoint", "ulimit -f 128; ");
    EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(EditProgram, KilledEditGoesOnToTheSameBytes) {
    ASSERT_EQ(run(edit(to("whole"))).code, 0);
    // The edit is killed as soon as it has written a checkpoint.
    const std::string killed = "'" ITEM3D_PROGRAM "' " + edit(to("parts")) +
                               " >/dev/null 2>&1 & pid=$!; while kill -0 $pid 2>/dev/null && "
                               "! [ -e " +
                               quoted(folder_ / "parts" / "checkpoint.safetensors") +
                               " ]; do sleep 0.02; done; kill -9 $pid; wait $pid";
    EXPECT_NE(std::system(killed.c_str()), 0);
    EXPECT_FALSE(fs::exists(folder_ / "parts" / "model.glb"));
    const Result resumed = run(edit(to("parts") + " --resume"));
    ASSERT_EQ(resumed.code, 0) << resumed.error;
    EXPECT_EQ(read_file(folder_ / "whole" / "model.glb"),
              read_file(folder_ / "parts" / "model.glb"));
}

}  // namespace
}  // namespace item3d::testing
