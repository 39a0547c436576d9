//! A real Slurm with two nodes on this machine, for tests: one controller and two node daemons, which talk
//! over 127.0.0.1 only.
//!
//! Everything Slurm writes lies in one temporary folder. Nothing is left behind: when a [`Slurm`] is dropped,
//! every process that belongs to it is killed, the running jobs too.

use std::array;
use std::collections::BTreeMap;
use std::env;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{self, Child, Command, Stdio};
use std::sync::atomic::{AtomicU16, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// The names of the two nodes. Each has one processor, so it runs one job at a time.
pub const NODES: [&str; 2] = ["n1", "n2"];

/// The programs a test needs.
const PROGRAMS: [&str; 7] = ["slurmctld", "slurmd", "sbatch", "scancel", "scontrol", "sinfo", "squeue"];

/// Where the daemons lie when the search path of a user leaves them out.
const DAEMON_FOLDERS: [&str; 2] = ["/usr/sbin", "/usr/local/sbin"];

/// How long a daemon may take to answer. Chosen: it takes 1 s on a free machine, 60 s allow for a busy one.
const START_LIMIT: Duration = Duration::from_secs(60);

/// A test that kills the controller and wants a job, or the start of a job, to be remembered waits this long
/// first. Chosen: Slurm saves its state at most every 5 s, and only some time after a change.
pub const SAVE_DELAY: Duration = Duration::from_secs(6);

/// Pause between two looks. Chosen: short against a job of 1 s, long against the 10 ms which squeue takes.
const PAUSE: Duration = Duration::from_millis(200);

/// Rounds of killing. Chosen: one is enough but for a process that just forked; 50 with a pause are 10 s.
const KILL_ROUNDS: usize = 50;

/// Lines of each log that a panic message shows. Chosen: they fit on one screen.
const LOG_TAIL: usize = 25;

/// First port tried. Chosen: below 32768, where Linux begins to hand out ports for outgoing connections, so
/// that no connection can take the port of a daemon while the daemon is dead.
const FIRST_PORT: u16 = 20_000;

/// Number of ports tried. Chosen: they end below 32768.
const PORT_COUNT: u16 = 12_000;

/// Ports already tried by this process.
static PORTS_TRIED: AtomicU16 = AtomicU16::new(0);

/// One job, or one element of a job array, as squeue tells it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// `12` for a single job, `12_3` for element 3 of array 12.
    pub id: String,
    /// `PENDING`, `RUNNING`, `COMPLETING`, `COMPLETED`, `FAILED`, `TIMEOUT`, `NODE_FAIL`, ...
    pub state: String,
    /// Why it has this state: `Resources`, `BeginTime`, `NonZeroExitCode`, `TimeLimit`, ...
    pub reason: String,
    /// The node it runs on or ran on, empty while it waits.
    pub node: String,
}

/// A running Slurm. Dropping it kills all its processes and removes its folder.
#[derive(Debug)]
pub struct Slurm {
    folder: TempDir,
    controller: Option<Child>,
    nodes: BTreeMap<String, Child>,
}

impl Slurm {
    /// Whether this machine has Slurm.
    pub fn is_installed() -> bool {
        PROGRAMS.iter().all(|program| find(program).is_some())
    }

    /// Starts the controller and the nodes and waits until both nodes are idle.
    pub fn start() -> Self {
        let folder = TempDir::with_prefix("slurm-").expect("a temporary folder");
        for name in ["logs", "state", "spool/n1", "spool/n2"] {
            fs::create_dir_all(folder.path().join(name)).expect("a folder for Slurm");
        }
        fs::write(folder.path().join("slurm.conf"), configuration(folder.path())).expect("slurm.conf");
        let mut slurm = Self { folder, controller: None, nodes: BTreeMap::new() };
        slurm.controller = Some(slurm.spawn_controller(&["-c"]));
        for node in NODES {
            slurm.start_node(node);
        }
        slurm.wait_until("both nodes are idle", START_LIMIT, |slurm| {
            slurm.node_states().iter().filter(|(_, state)| state == "idle").count() == NODES.len()
        });
        slurm
    }

    /// The configuration file, the value of `SLURM_CONF`.
    pub fn conf(&self) -> PathBuf {
        self.folder.path().join("slurm.conf")
    }

    /// A command that talks to this Slurm and to no other: it gets `SLURM_CONF`, a search path with the
    /// daemons, and none of the Slurm settings the test itself may run under.
    pub fn command(&self, program: &str) -> Command {
        let mut command = Command::new(find(program).unwrap_or_else(|| program.into()));
        for (key, _) in env::vars_os() {
            if ["SLURM", "SBATCH", "SQUEUE", "SINFO"]
                .iter()
                .any(|start| key.to_string_lossy().starts_with(start))
            {
                command.env_remove(key);
            }
        }
        command.env("PATH", env::join_paths(search_path()).expect("a search path"));
        command.env("SLURM_CONF", self.conf());
        command
    }

    /// Runs a command of Slurm and gives what it prints; panics when it fails.
    pub fn run(&self, program: &str, arguments: &[&str]) -> String {
        self.try_run(program, arguments)
            .unwrap_or_else(|error| panic!("{program} {arguments:?} failed: {error}\n{}", self.logs()))
    }

    /// The jobs that wait, run or end at this moment; one entry for each array element.
    pub fn jobs(&self) -> Vec<Job> {
        parse_jobs(&self.run("squeue", &[&JOB_COLUMNS[..], &["--sort=i"]].concat()))
    }

    /// Name and state of each node; a state with a star means that the node does not answer.
    pub fn node_states(&self) -> Vec<(String, String)> {
        let output = self.try_run("sinfo", &["--noheader", "--Node", "--format=%N %T"]).unwrap_or_default();
        let words = output.lines().filter_map(|line| line.split_once(' '));
        words.map(|(name, state)| (name.to_owned(), state.trim().to_owned())).collect()
    }

    /// Kills the node as a power cut does: its daemon and all that runs there, at once and without a word to
    /// the controller. The controller notices by itself after some 20 s; see also [`Slurm::declare_down`].
    pub fn kill_node(&mut self, node: &str) {
        kill_all(&self.node_folder(node), &[self.conf_mark(), format!("SLURMD_NODENAME={node}")]);
        let mut daemon = self.nodes.remove(node).unwrap_or_else(|| panic!("node {node} does not run"));
        daemon.wait().expect("the end of the node");
    }

    /// Starts the daemon of a node; does not wait, since the controller may be dead.
    pub fn start_node(&mut self, node: &str) {
        let mut command = self.command("slurmd");
        // Its helpers, one for each job, keep this folder: so [`Slurm::kill_node`] finds them.
        command.args(["-D", "-N", node]).current_dir(self.node_folder(node));
        let daemon = spawn(command, &self.log(node));
        assert!(self.nodes.insert(node.to_owned(), daemon).is_none(), "node {node} runs already");
    }

    /// Tells the controller that the node is down, which spares the test the wait. A node that comes back is
    /// used again all the same.
    pub fn declare_down(&self, node: &str) {
        self.run("scontrol", &["update", &format!("NodeName={node}"), "State=DOWN", "Reason=killed"]);
    }

    /// Kills the controller as a power cut does. What happened in the last [`SAVE_DELAY`] may be lost: a job
    /// that was just submitted is forgotten and its number given out again, an element that just ended is
    /// taken for running, one that just started is started twice.
    pub fn kill_controller(&mut self) {
        self.end_controller("KILL");
    }

    /// Starts the controller from the state it has saved and waits until it answers.
    pub fn start_controller(&mut self) {
        assert!(self.controller.is_none(), "the controller runs already");
        self.controller = Some(self.spawn_controller(&[]));
        self.wait_until("the controller answers", START_LIMIT, |slurm| {
            slurm.try_run("scontrol", &["ping"]).is_ok_and(|answer| answer.contains("is UP"))
        });
    }

    /// Moves the time limit of a running job to `seconds` from now. The controller looks at the limits every
    /// 30 s: a warning asked for N s ahead comes N to N + 30 s ahead, and may be left out if `seconds` is
    /// below 30; the end comes up to 30 s late, and `KillWait` later for a job that does not heed SIGTERM.
    pub fn end_in(&self, job: &str, seconds: u64) {
        let end = format!("EndTime=now+{seconds}seconds");
        self.run("scontrol", &["update", &format!("JobId={job}"), &end]);
    }

    /// Waits until no job waits, runs or is held.
    pub fn wait_until_idle(&self, limit: Duration) {
        self.wait_until("no job is left", limit, |slurm| slurm.jobs().is_empty());
    }

    /// Waits until something holds; after `limit` it panics with the jobs, the nodes and the logs.
    pub fn wait_until(&self, what: &str, limit: Duration, mut holds: impl FnMut(&Self) -> bool) {
        let start = Instant::now();
        while !holds(self) {
            assert!(start.elapsed() < limit, "after {limit:?}, not yet: {what}\n{}", self.report());
            sleep(PAUSE);
        }
    }

    /// The end of each log.
    pub fn logs(&self) -> String {
        ["controller", NODES[0], NODES[1]].iter().fold(String::new(), |mut text, name| {
            let log = fs::read(self.log(name)).unwrap_or_default();
            let log = String::from_utf8_lossy(&log);
            let lines: Vec<&str> = log.lines().collect();
            let tail = lines[lines.len().saturating_sub(LOG_TAIL)..].join("\n");
            write!(text, "--- {name}\n{tail}\n").expect("writing to a string");
            text
        })
    }

    /// Jobs, nodes and logs, for a panic message.
    fn report(&self) -> String {
        let jobs = self.try_run("squeue", &["--array", "--states=all"]).unwrap_or_else(|error| error);
        format!("--- jobs\n{jobs}--- nodes\n{:?}\n{}", self.node_states(), self.logs())
    }

    /// Runs a command of Slurm; gives what it prints, or what it complains about.
    fn try_run(&self, program: &str, arguments: &[&str]) -> Result<String, String> {
        let output = self.command(program).args(arguments).stdin(Stdio::null()).output();
        let output = output.map_err(|error| error.to_string())?;
        let text = if output.status.success() { &output.stdout } else { &output.stderr };
        let text = String::from_utf8_lossy(text).into_owned();
        if output.status.success() { Ok(text) } else { Err(text) }
    }

    fn spawn_controller(&self, arguments: &[&str]) -> Child {
        let mut command = self.command("slurmctld");
        command.arg("-D").args(arguments).current_dir(self.folder.path());
        spawn(command, &self.log("controller"))
    }

    fn end_controller(&mut self, name: &str) {
        let mut controller = self.controller.take().expect("the controller does not run");
        signal(name, &[controller.id()]);
        controller.wait().expect("the end of the controller");
    }

    fn log(&self, name: &str) -> PathBuf {
        self.folder.path().join("logs").join(format!("{name}.log"))
    }

    /// The folder of a node, in which its daemon and the helpers of its jobs work.
    fn node_folder(&self, node: &str) -> PathBuf {
        self.folder.path().join("spool").join(node)
    }

    /// What the environment of each job and command of this Slurm holds, and of no other process.
    fn conf_mark(&self) -> String {
        format!("SLURM_CONF={}", self.conf().display())
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        kill_all(self.folder.path(), &[self.conf_mark()]);
        // Only to collect the dead; there is nothing to do about a failure.
        self.controller.iter_mut().chain(self.nodes.values_mut()).for_each(|daemon| drop(daemon.wait()));
    }
}

/// The arguments that make squeue print the fields of a [`Job`].
const JOB_COLUMNS: [&str; 3] = ["--noheader", "--array", "--format=%i|%T|%r|%N"];

fn parse_jobs(output: &str) -> Vec<Job> {
    output.lines().map(parse_job).collect()
}

fn parse_job(line: &str) -> Job {
    let fields: Vec<&str> = line.split('|').map(str::trim).collect();
    let &[id, state, reason, node] = fields.as_slice() else { panic!("squeue printed {line:?}") };
    Job { id: id.into(), state: state.into(), reason: reason.into(), node: node.into() }
}

/// The folders to look for programs in.
fn search_path() -> Vec<PathBuf> {
    let path = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&path).chain(DAEMON_FOLDERS.map(PathBuf::from)).collect()
}

fn find(program: &str) -> Option<PathBuf> {
    search_path().into_iter().map(|folder| folder.join(program)).find(|file| file.is_file())
}

/// Starts a daemon that writes to the end of a log.
fn spawn(mut command: Command, log: &Path) -> Child {
    let log = File::options().create(true).append(true).open(log).expect("a log for a daemon");
    let copy = log.try_clone().expect("a second handle of the log");
    command.stdin(Stdio::null()).stdout(copy).stderr(log);
    command.spawn().unwrap_or_else(|error| panic!("cannot start {command:?}: {error}"))
}

/// Kills what [`processes_with`] finds. All are stopped before the first is killed, so that none can tell the
/// controller of the death of another.
fn kill_all(folder: &Path, marks: &[String]) {
    for _ in 0..KILL_ROUNDS {
        let found = processes_with(folder, marks);
        if found.is_empty() {
            return;
        }
        signal("STOP", &found);
        signal("KILL", &found);
        sleep(PAUSE);
    }
}

/// Sends a signal; a process that is gone already does not matter.
fn signal(name: &str, processes: &[u32]) {
    let processes = processes.iter().map(u32::to_string);
    let mut command = Command::new("sh");
    command.args(["-c", "kill -s \"$@\"", "kill", name]).args(processes).stderr(Stdio::null());
    command.status().expect("the shell");
}

/// The processes that work in a folder or below it, and those whose environment holds all the marks. Both
/// are needed: the daemons overwrite their environment, and the jobs work where they like. A dead process has
/// neither.
fn processes_with(folder: &Path, marks: &[String]) -> Vec<u32> {
    let folder = folder.canonicalize().expect("the folder of Slurm");
    let entries = fs::read_dir("/proc").into_iter().flatten().flatten();
    let numbers = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    numbers.filter(|process| works_in(*process, &folder) || has_marks(*process, marks)).collect()
}

fn works_in(process: u32, folder: &Path) -> bool {
    fs::read_link(format!("/proc/{process}/cwd")).is_ok_and(|place| place.starts_with(folder))
}

fn has_marks(process: u32, marks: &[String]) -> bool {
    let environment = fs::read(format!("/proc/{process}/environ")).unwrap_or_default();
    let variables: Vec<&[u8]> = environment.split(|&byte| byte == 0).collect();
    marks.iter().all(|mark| variables.contains(&mark.as_bytes()))
}

/// Three free ports. They start where no other process starts, so that two tests do not meet.
fn free_ports() -> [u16; 3] {
    let own = (process::id() % u32::from(PORT_COUNT / 3)) as u16 * 3;
    let mut free = (0..PORT_COUNT)
        .map(|_| FIRST_PORT + (own + PORTS_TRIED.fetch_add(1, Ordering::Relaxed) % PORT_COUNT) % PORT_COUNT)
        .filter(|&port| TcpListener::bind(("127.0.0.1", port)).is_ok());
    array::from_fn(|_| free.next().expect("a free port"))
}

/// The name of this machine as Slurm wants it: without the domain.
fn host_name() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").expect("the name of this machine");
    name.trim().split('.').next().unwrap_or_default().to_owned()
}

/// The name of the user, who owns the daemons and runs the jobs.
fn user_name() -> String {
    let output = Command::new("id").arg("-un").output().expect("the program id");
    String::from_utf8_lossy(&output.stdout).trim().to_owned()
}

/// The text of slurm.conf. Chosen there:
/// - no authentication, no accounting, no process containment: they need services a test machine lacks;
/// - `SlurmdTimeout`: a dead node is noticed soon, and a busy machine still answers in time;
/// - `KillWait`: a job that ignores its time limit is killed soon;
/// - `sched/builtin`: each start of a job is saved, which `sched/backfill` does not see to;
/// - `ReturnToService=2`: a node that comes back is used again;
/// - `MinJobAge`: ended jobs stay visible for an hour;
/// - `config_overrides`: the nodes count as described here, whatever the machine has;
/// - `sched_interval`: a job that was held starts soon after its time has come.
fn configuration(folder: &Path) -> String {
    let folder = folder.display();
    let (host, user) = (host_name(), user_name());
    let [controller, first, second] = free_ports();
    format!(
        "\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/none
CredType=cred/none
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MailProg=/bin/true
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=2
SlurmdParameters=config_overrides
ReturnToService=2
SlurmdTimeout=5
KillWait=3
MinJobAge=3600
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool/%n
SlurmctldPidFile={folder}/controller.pid
SlurmdPidFile={folder}/%n.pid
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={first} CPUs=1 RealMemory=4000
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={second} CPUs=1 RealMemory=4000
PartitionName=main Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
"
    )
}
