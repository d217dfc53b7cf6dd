// SPDX-License-Identifier: GPL-3.0-or-later
//
// A job type for Flamenco 3: bakes the Lamina layers of .blend files, one task per file. Put this file into the folder
// `scripts` beside the Flamenco Manager. The workers' Blender needs the extension Lamina.

const JOB_TYPE = {
    label: "Lamina Bake",
    description: "Bake the Lamina layers of materials, and save each file over itself",
    settings: [
        // Settings for artists to determine:
        { key: "more_files", type: "string", required: false, default: "", visible: "submission",
          description: "Further .blend files that every worker can read, separated by semicolons" },
        { key: "quality", type: "string", required: true, default: "final", choices: ["final", "preview"],
          description: "Accuracy of the solver and of the fit" },
        { key: "materials", type: "string", required: false, default: "",
          description: "Names or patterns of the materials to bake, separated by semicolons; empty: all with layers" },
        { key: "force", type: "bool", required: false, default: false,
          description: "Bake again what is up to date" },
        { key: "threads", type: "int32", required: false, default: 0,
          description: "Threads of each worker; 0 is all" },

        // Automatically evaluated settings:
        { key: "blendfile", type: "string", required: true, visible: "web",
          description: "Path of the .blend file to bake" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    for (const file of filesOf(settings)) {
        const task = author.Task(`bake-${path.basename(file)}`, "blender");
        // Flamenco's own command for Blender finds the program and fails on any exit code but 0.
        task.addCommand(author.Command("blender-render", {
            exe: "{blender}",
            exeArgs: "{blenderArgs}",
            argsBefore: ["--background"],
            blendfile: file,
            args: ["--python-exit-code", "1", "--command", "lamina", "bake"].concat(argumentsOf(settings)),
        }));
        job.addTask(task);
    }
}

// The files, each once: two tasks must not write the same file.
function filesOf(settings) {
    const files = [settings.blendfile].concat(listOf(settings.more_files));
    return files.filter((file, index) => files.indexOf(file) === index);
}

function argumentsOf(settings) {
    if (!["final", "preview"].includes(settings.quality)) {
        throw new Error(`quality = ${settings.quality}: must be final or preview`);
    }
    const threads = settings.threads || 0;
    if (!Number.isInteger(threads) || threads < 0 || threads > 1024) {
        throw new Error(`threads = ${threads}: must be a whole number from 0 (all) to 1024`);
    }
    const materials = listOf(settings.materials).map((name) => `--materials=${name}`);
    const force = settings.force ? ["--force"] : [];
    return ["--quality", settings.quality, "--threads", String(threads)].concat(force, materials, ["--save"]);
}

// The parts of a text between semicolons, without spaces around them and without empty parts.
function listOf(text) {
    return (text || "").split(";").map((part) => part.trim()).filter((part) => part.length > 0);
}
