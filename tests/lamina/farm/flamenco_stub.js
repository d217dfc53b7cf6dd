// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stand-in for what Flamenco's Manager gives to a job type. Compiles one job with the settings of the second argument
// (JSON), and prints the type and the tasks as JSON.

const fs = require("fs");
const vm = require("vm");

const tasks = [];
const context = {
    path: require("path").posix,
    print: () => {},
    author: {
        Task: (name, type, priority) => ({
            name, type, priority, commands: [], dependencies: [],
            addCommand(command) { this.commands.push(command); },
            addDependency(task) { this.dependencies.push(task.name); },
        }),
        Command: (name, parameters) => ({ name, parameters }),
    },
    job: { name: "bake", settings: JSON.parse(process.argv[3]), addTask: (task) => tasks.push(task) },
};
vm.createContext(context);
vm.runInContext(fs.readFileSync(process.argv[2], "utf8"), context);
try {
    vm.runInContext("compileJob(job)", context);
} catch (error) {
    console.error(error.message);
    process.exit(1);
}
console.log(JSON.stringify({ type: vm.runInContext("JOB_TYPE", context), tasks }));
