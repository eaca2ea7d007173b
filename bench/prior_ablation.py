#!/usr/bin/env python3
"""Measures how each choice in the training of the embedded prior affects its accuracy (an ablation study).

    bench/prior_ablation.py ITEM3D OUTPUT --samples 40000 --data 40000

The script trains several short contenders, each of which differs from the recipe in one option. All have the same seed
and the same number of images. A diffusion classifier then measures each contender on held-out shapes: the accuracy is
the share of images whose correct word has the lowest denoising loss among at most 31 words of its kind. Finished
trainings are kept, so the same command resumes a run that was stopped. The script writes OUTPUT/ablation.json and
prints a Markdown table.
"""
import argparse
import json
import pathlib
import shutil
import subprocess

CONTENDERS = {
    "the recipe": [],
    "depth alone": ["--condition", "depth"],
    "no shape": ["--condition", "none"],
    "epsilon": ["--prediction", "epsilon"],
    "adamw": ["--optimizer", "adamw"],
    "widths 32,64,96": ["--widths", "32,64,96"],
    "widths 64,128,192": ["--widths", "64,128,192"],
    "a third of the patterns": ["--patterns", "0.33"],
    "twice the patterns": ["--patterns", "2"],
    "128 pixels": ["--resolution", "128"],
}
# Contenders with these options need training data of their own. All others share the data of the recipe.
OWN_DATA = ("--patterns", "--resolution")
KINDS = ("colors", "materials", "patterns", "lights")


def train(options, name, arguments):
    """Trains a contender and returns the contents of its prior.json."""
    folder = options.output / name.replace(" ", "_").replace(",", "_")
    done = folder / "prior.json"
    if done.exists() and "kinds" in json.loads(done.read_text()):
        return json.loads(done.read_text())
    first = options.output / "the_recipe"
    work = folder / "work"
    if not work.exists() and folder != first and not any(word in arguments for word in OWN_DATA):
        work.mkdir(parents=True)
        for file in ("settings.json", "autoencoder.json", "data.safetensors"):
            shutil.copy(first / "work" / file, work)
        for part in ("tokenizer", "vae"):
            shutil.copytree(first / part, folder / part)
        for file in ("model_index.json", "prior.json"):
            shutil.copy(first / file, folder)
        prior = json.loads(done.read_text())
        done.write_text(json.dumps({key: prior[key] for key in ("words", "resolution")}))
    if options.autoencoder and "--resolution" not in arguments:
        arguments = ["--autoencoder", options.autoencoder, *arguments]
    subprocess.run(
        [options.item3d, "prior", "train", "-o", folder, "--part", "diffusion", "--samples", str(options.samples),
         "--data", str(options.data), "--autoencoder-samples", str(options.autoencoder_samples),
         "--word-images", str(options.word_images), "--seed", str(options.seed), "--resume", *arguments],
        check=True)
    return json.loads(done.read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("item3d", help="the program")
    parser.add_argument("output", type=pathlib.Path, help="folder for all trainings and results")
    parser.add_argument("--samples", type=int, default=40000,
                        help="number of training images of the U-Net, including repetitions")
    parser.add_argument("--data", type=int, default=40000, help="number of different images for the U-Net")
    parser.add_argument("--autoencoder-samples", type=int, default=24000,
                        help="number of training images of the autoencoder, including repetitions")
    parser.add_argument("--autoencoder", metavar="PRIOR",
                        help="prior whose autoencoder all contenders use, except those with another image size")
    parser.add_argument("--word-images", type=int, default=6, help="number of held-out images for each word")
    parser.add_argument("--seed", type=int, default=1, help="seed of all trainings")
    parser.add_argument("--only", nargs="+", choices=CONTENDERS, default=list(CONTENDERS),
                        help="contenders to train besides the recipe")
    options = parser.parse_args()
    table = {}
    for name in ["the recipe"] + [name for name in options.only if name != "the recipe"]:
        prior = train(options, name, CONTENDERS[name])
        table[name] = {
            "parameters": prior["train"]["parameters"],
            "seconds": prior["train"]["seconds"],
            "loss": prior["train"]["loss"],
            **{kind: prior["kinds"][kind]["accuracy"] for kind in KINDS},
        }
    (options.output / "ablation.json").write_text(json.dumps(table, indent=2) + "\n")
    print("| | " + " | ".join(KINDS) + " | loss | million parameters | seconds |")
    print("|---" * (len(KINDS) + 4) + "|")
    for name, row in table.items():
        cells = [f"{row[kind]:.2f}" for kind in KINDS]
        print(f"| {name} | " + " | ".join(cells) +
              f" | {row['loss']:.3f} | {row['parameters'] / 1e6:.1f} | {row['seconds']:.0f} |")


if __name__ == "__main__":
    main()
