// Command item3d study: makes, serves and analyses user studies of a comparison.
#include "apps/item3d/command.h"
#include "apps/item3d/study/commands.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/serve/http_listener.h"
#include "item3d/study/analysis_tables.h"
#include "item3d/study/make_study.h"
#include "item3d/study/server.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>

namespace item3d {
namespace {

struct MakeOptions : CommonOptions {
    MakeStudyRequest request;
};

void run_make(const MakeOptions& options) {
    const Study study = make_study(options.request);
    const std::string folder = options.request.output.string();
    if (options.json) {
        print_json({{"study", folder}, {"methods", study.methods}, {"pages", study.items.size()}});
        return;
    }
    fmt::print("{}\n", folder);
    note(
        fmt::format("{} pages for each participant; check the consent text in {}/study.json, then "
                    "run: item3d study serve {}",
                    study.items.size(), folder, folder));
}

void add_make(CLI::App& app) {
    auto options = std::make_shared<MakeOptions>();
    CLI::App* command =
        add_command(app, "make", "Make a study from the results of a comparison", *options);
    MakeStudyRequest& request = options->request;
    command->add_option("COMPARISON", request.comparison, "Output folder of item3d compare")
        ->required();
    command->add_option("-o,--output", request.output, "Folder for the study")
        ->type_name("FOLDER")
        ->required();
    command->add_option("--title", request.title, "Title of the first page")->capture_default_str();
    command
        ->add_option("--consent", request.consent,
                     "Text that participants agree to, with empty lines between paragraphs. "
                     "Default: a draft")
        ->type_name("FILE");
    command
        ->add_option("--practice", request.practice,
                     "Practice pages at the start, whose answers do not count")
        ->check(CLI::Range(0, 2))
        ->capture_default_str();
    command
        ->add_option("--attention", request.attention,
                     "Attention checks, which ask for two given numbers")
        ->check(CLI::Range(0, 10))
        ->capture_default_str();
    command->add_option("--seed", request.seed, "Seed of names, orders and positions")
        ->check(seed_check())
        ->capture_default_str();
    command->callback([options] {
        start_command(*options);
        run_make(*options);
    });
}

/// The number of participants who rated the paper's table.
constexpr int default_participants = 33;

struct ServeOptions : CommonOptions {
    std::filesystem::path folder;
    std::string host = "127.0.0.1";
    int port = 8080;
    int participants = 0;  ///< 0: those of earlier starts, or default_participants
    std::string address;   ///< public address; empty: that of host and port
};

void print_links(const ServeOptions& options, const std::string& address,
                 const std::vector<Participant>& participants) {
    nlohmann::json links = nlohmann::json::array();
    for (const Participant& participant : participants) {
        const std::string link = address + participant_path(participant);
        links.push_back({{"participant", participant.number}, {"link", link}});
        if (!options.json) fmt::print("{}\t{}\n", participant.number, link);
    }
    if (options.json) print_json({{"address", address}, {"links", links}});
    if (std::fflush(stdout) != 0) throw ResourceError("stdout: cannot be written");
}

/// Serves until Ctrl-C, which is a normal end.
void run_serve(const ServeOptions& options) {
    const Study study = read_study(options.folder);
    check_study_images(study, options.folder);
    AnswerStore answers(options.folder, study);
    const bool is_first = answers.participants().empty();
    answers.add_participants(options.participants == 0 && is_first ? default_participants
                                                                   : options.participants);
    StudySite site(study, answers, options.folder);
    const StudyServer server(site, options.host, options.port);
    std::string address = options.address;
    while (address.ends_with('/'))
        address.pop_back();
    if (address.empty()) address = server_address(options.host, server.port());
    if (!is_loopback(options.host))
        note(
            "other machines can reach this page without encryption; use a reverse proxy with HTTPS "
            "in a network that you do not trust");
    print_links(options, address, answers.participants());
    note(fmt::format("serving {} on {} until Ctrl-C", options.folder.string(),
                     server_address(options.host, server.port())));
    while (!interrupted())
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    note("ended; all answers are stored in " + (options.folder / "answers.sqlite").string());
}

void add_serve(CLI::App& app) {
    auto options = std::make_shared<ServeOptions>();
    CLI::App* command = add_command(
        app, "serve", "Serve a study to participants, each with a personal link", *options);
    command->add_option("STUDY", options->folder, "Output folder of item3d study make")->required();
    command
        ->add_option(
            "--participants", options->participants,
            fmt::format("Number of links; a larger number than before adds links. Default: "
                        "{}, or as many as there are",
                        default_participants))
        ->check(CLI::Range(1, 10000));
    command
        ->add_option("--host", options->host,
                     "Address to listen on; 0.0.0.0: all addresses of this machine, which other "
                     "machines can reach")
        ->type_name("ADDRESS")
        ->capture_default_str();
    command->add_option("--port", options->port, "Port to listen on; 0: any free port")
        ->check(CLI::Range(0, 65535))
        ->capture_default_str();
    command
        ->add_option(
            "--address", options->address,
            "Public address at the start of the links, if it differs: https://study.example.org")
        ->type_name("URL")
        ->check(CLI::Validator(
            [](const std::string& url) -> std::string {
                if (url.starts_with("http://") || url.starts_with("https://")) return "";
                return "an address begins with http:// or https://";
            },
            "URL"));
    command->callback([options] {
        start_command(*options);
        run_serve(*options);
    });
}

struct AnalyzeOptions : CommonOptions {
    std::filesystem::path folder;
    AnalysisOptions analysis;
};

void run_analyze(const AnalyzeOptions& options) {
    const Study study = read_study(options.folder);
    const auto answers = read_answers(options.folder, study);
    const StudyAnalysis analysis =
        analyze_study(study, answers, options.analysis, options.folder.string());
    write_atomically(options.folder / "ratings.csv", ratings_csv(study, answers));
    const std::string table = options.analysis.counts_inattentive ? "table_all" : "table";
    write_atomically(options.folder / (table + ".csv"), analysis_csv(analysis));
    write_atomically(options.folder / (table + ".tex"), analysis_latex(analysis));
    if (options.json)
        print_json(analysis_json(analysis));
    else
        fmt::print("{}", analysis_text(analysis));
}

void add_analyze(CLI::App& app) {
    auto options = std::make_shared<AnalyzeOptions>();
    CLI::App* command = add_command(
        app, "analyze",
        "Print ratings, tests and agreement; write ratings.csv, table.csv and table.tex", *options);
    command->add_option("STUDY", options->folder, "Folder of the study")->required();
    command->add_flag("--all", options->analysis.counts_inattentive,
                      "Include participants whose attention checks failed; writes table_all.csv "
                      "and table_all.tex");
    command
        ->add_option("--resamples", options->analysis.resamples,
                     "Bootstrap resamples of the participants, for the intervals")
        ->check(CLI::Range(100, 1000000))
        ->capture_default_str();
    command->add_option("--seed", options->analysis.seed, "Seed of the resampling")
        ->check(seed_check())
        ->capture_default_str();
    command->callback([options] {
        start_command(*options);
        run_analyze(*options);
    });
}

}  // namespace

void add_study_command(CLI::App& app) {
    CLI::App* command = add_command_group(app, "study");
    command->require_subcommand(1);
    add_make(*command);
    add_serve(*command);
    add_analyze(*command);
}

}  // namespace item3d
