//! The buffers of a window on a device, and the execution of recorded commands on them. A *job* is the numbers that one
//! dispatch of a pass is given.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use tilescope_core::Stage;
use tilescope_trusted::Checks;

use crate::constants::{GROUP_COLUMNS, WORKGROUP};
use crate::error::GpuError;
use crate::layout::{Job, Name};
use crate::opened::Gpu;
use crate::pass_report::{PassReport, Recording};
use crate::passes::{Command, Pass, Size};
use crate::plan::{Phase, WindowPlan};
use crate::setup::Setup;

/// Bytes from one job to the next in their buffer: the alignment that every device supports.
const JOB_STRIDE: u64 = 256;

/// The most timestamps from one reading of the times to the next: two for each pass, before and after it.
const MAX_TIMESTAMPS: u32 = 1024;

/// The buffers of a window, and the commands run on them.
pub(crate) struct Device {
    gpu: Arc<Gpu>,
    buffers: BTreeMap<Name, (wgpu::Buffer, u64)>,
    jobs: wgpu::Buffer,
    /// The most bytes that the buffers have held at once.
    pub highest_bytes: u64,
    recording: Recording,
    /// How often the two lists of active cells were swapped.
    pub swaps: u32,
    /// The passes so far, if they are reported.
    pub reports: Option<Vec<PassReport>>,
    times: Option<Times>,
}

/// Times of passes, where the adapter measures them.
struct Times {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    /// Indices into the reports of the passes timed since the last reading.
    pending: Vec<usize>,
    period_ns: f64,
}

impl Device {
    /// Returns the buffers for the first phase of a plan. A device from `before` goes on with its reports, its count of
    /// swaps, and the buffers that are long enough; it must have been made with the same `recording`.
    ///
    /// Fails when the device has no memory for them, is lost or refuses a command.
    pub(crate) async fn new(
        gpu: &Arc<Gpu>,
        setup: &Setup,
        plan: &WindowPlan,
        before: Option<Self>,
        recording: Recording,
    ) -> Result<Self, GpuError> {
        let mut device = match before {
            Some(device) => device,
            None => Self::empty(gpu, recording)?,
        };

        device.enter(setup, plan, Phase::Tile).await?;
        device.write(Name::Frame, bytemuck::bytes_of(&plan.uniform))?;
        device.write(Name::Images, bytemuck::cast_slice(&plan.images))?;
        device.write(Name::Pieces, bytemuck::cast_slice(&plan.pieces))?;
        device.write(Name::Pattern, bytemuck::cast_slice(&setup.pattern))?;

        gpu.check()?;
        Ok(device)
    }

    /// Frees the buffers that a phase does not need, and allocates those that are missing or too short.
    pub(crate) async fn enter(
        &mut self,
        setup: &Setup,
        plan: &WindowPlan,
        phase: Phase,
    ) -> Result<(), GpuError> {
        let keeps_stages = self.recording == Recording::Stages;
        let mut lengths = plan.lengths(setup, keeps_stages);
        lengths.push((Name::Frame, size_of_val(&plan.uniform) as u64));
        // Recorded runs keep every buffer, since each can be inspected up to the end.
        lengths.retain(|(name, _)| keeps_stages || phase.needs(*name, setup.sources));
        self.hold(lengths).await
    }

    /// Frees the buffers that are not named, and allocates those that are missing or shorter than the lengths in bytes.
    pub(crate) async fn hold(&mut self, lengths: Vec<(Name, u64)>) -> Result<(), GpuError> {
        // Buffers are freed before others are allocated, so that their memory can be used.
        self.buffers.retain(|name, (_, have)| {
            lengths
                .iter()
                .any(|(needed, length)| needed == name && *have >= *length)
        });

        // A browser reports a lack of memory later, and only to an error scope opened before.
        let scope = self
            .gpu
            .device
            .push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        for (name, length) in lengths {
            if !self.buffers.contains_key(&name) {
                self.allocate(name, length)?;
            }
        }

        if scope.pop().await.is_some() {
            // The scope does not say which buffer is missing, so none can be used.
            self.buffers.clear();
            return Err(GpuError::OutOfMemory);
        }

        self.highest_bytes = self.highest_bytes.max(self.held_bytes());
        self.gpu.check()
    }

    /// Returns a device without buffers of a run.
    pub(crate) fn empty(gpu: &Arc<Gpu>, recording: Recording) -> Result<Self, GpuError> {
        let jobs = gpu.buffer(
            "jobs",
            // More than enough: a part of the commands has half as many passes (see `submit`).
            JOB_STRIDE * u64::from(MAX_TIMESTAMPS),
            wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        )?;

        let reports = recording != Recording::Nothing;
        let times = reports && gpu.report().has_timestamps;

        Ok(Self {
            gpu: Arc::clone(gpu),
            buffers: BTreeMap::new(),
            jobs,
            highest_bytes: 0,
            recording,
            swaps: 0,
            reports: reports.then(Vec::new),
            times: times.then(|| Times::new(gpu)).transpose()?,
        })
    }

    /// Makes a buffer in the place of the one of the same name.
    fn allocate(&mut self, name: Name, length: u64) -> Result<(), GpuError> {
        // WebGPU does not allow bindings of length 0. 32 bytes hold an element of each list that may be empty. Buffers
        // are read and written by words of 4 bytes.
        let length = length.max(32).next_multiple_of(4);
        let usage = if matches!(name, Name::Frame | Name::Ground) {
            wgpu::BufferUsages::UNIFORM
        } else if name == Name::Arguments {
            wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT
        } else {
            wgpu::BufferUsages::STORAGE
        };

        let copies = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let buffer = self.gpu.buffer(name.as_str(), length, usage | copies)?;
        self.buffers.insert(name, (buffer, length));
        Ok(())
    }

    /// Writes the beginning of a buffer. Fails if the buffer is too short.
    pub(crate) fn write(&self, name: Name, bytes: &[u8]) -> Result<(), GpuError> {
        match self.buffers.get(&name) {
            Some((buffer, length)) if bytes.len() as u64 <= *length => {
                self.gpu.queue.write_buffer(buffer, 0, bytes);
                Ok(())
            }
            _ => Err(GpuError::OutOfMemory),
        }
    }

    /// Writes a word of a buffer. An index past the end is ignored, and so is a buffer that is not allocated.
    pub(crate) fn set_word(&self, name: Name, index: u64, word: u32) {
        if let Some((buffer, length)) = self.buffers.get(&name)
            && index < length / 4
        {
            self.gpu
                .queue
                .write_buffer(buffer, 4 * index, &word.to_le_bytes());
        }
    }

    /// Returns a buffer's length in bytes, or 0 if it is not allocated.
    pub(crate) fn length(&self, name: Name) -> u64 {
        self.buffers.get(&name).map_or(0, |(_, length)| *length)
    }

    /// Returns the buffers with their lengths in bytes.
    pub(crate) fn lengths(&self) -> Vec<(Name, u64)> {
        let lengths = self.buffers.iter();
        lengths
            .map(|(&name, (_, length))| (name, *length))
            .collect()
    }

    /// Returns the bytes of all buffers.
    pub(crate) fn held_bytes(&self) -> u64 {
        self.buffers.values().map(|(_, length)| length).sum()
    }

    /// Returns bytes of a buffer, up to its end; none if it is not allocated.
    pub(crate) async fn bytes(&self, name: Name, range: Range<u64>) -> Result<Vec<u8>, GpuError> {
        let Some((buffer, length)) = self.buffers.get(&name) else {
            return Ok(Vec::new());
        };
        self.gpu
            .read(buffer, range.start..range.end.min(*length))
            .await
    }

    /// Returns words of a buffer, as [`Self::bytes`].
    pub(crate) async fn words(&self, name: Name, range: Range<u64>) -> Result<Vec<u32>, GpuError> {
        let bytes = self.bytes(name, 4 * range.start..4 * range.end).await?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }

    /// Submits commands to the queue, in parts whose jobs and timestamps have room.
    pub(crate) fn submit(&mut self, commands: &[Command], stage: Stage) -> Result<(), GpuError> {
        self.gpu.check()?;
        // A part has no more passes than there are pairs of timestamps, and fewer than the buffer of jobs holds. Times
        // are read later, so that passes of later parts may have none.
        for part in commands.chunks(MAX_TIMESTAMPS as usize / 2) {
            self.write_jobs(part);
            // A pass without its own job would use the job of another pass.
            self.gpu.check()?;

            let mut encoder = self.gpu.encoder();
            for (command, job) in part.iter().zip(0..) {
                self.encode(&mut encoder, command, job, stage);
            }
            self.gpu.queue.submit([encoder.finish()]);
        }
        Ok(())
    }

    /// Writes the jobs of passes, each at the place of its command.
    fn write_jobs(&self, commands: &[Command]) {
        let mut bytes = vec![0_u8; commands.len() * JOB_STRIDE as usize];
        for (command, to) in commands.iter().zip(bytes.chunks_mut(JOB_STRIDE as usize)) {
            if let Command::Dispatch { job, .. } = command {
                to[..size_of::<Job>()].copy_from_slice(bytemuck::bytes_of(job));
            }
        }
        self.gpu.queue.write_buffer(&self.jobs, 0, &bytes);
    }

    /// Appends a command to `encoder`. Its job is number `job` in the buffer of jobs.
    fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        command: &Command,
        job: u64,
        stage: Stage,
    ) {
        match *command {
            Command::Clear(name, words) => {
                // A buffer that this phase does not hold has nothing to clear.
                if let Some((buffer, _)) = self.buffers.get(&name) {
                    // Bounds are in bytes, four a word. Without a length all of the buffer is cleared.
                    let (first, length) = words.map_or((0, None), |(start, end)| {
                        (4 * u64::from(start), Some(4 * u64::from(end - start)))
                    });
                    encoder.clear_buffer(buffer, first, length);
                }
            }

            Command::SwapActive => {
                // Passes find buffers by name as they are encoded, so swapping names swaps the lists, and nothing is
                // copied. The level of the active cells follows from the number of swaps; open cells have no such
                // number.
                self.swaps += 1;
                self.swap(Name::Active, Name::NextActive);
            }
            Command::SwapOpen => self.swap(Name::OpenCells, Name::NextOpenCells),

            Command::Dispatch { pass, size, .. } => {
                self.dispatch(encoder, pass, size, job, stage);
            }
        }
    }

    /// Gives two buffers each other's names.
    fn swap(&mut self, a: Name, b: Name) {
        let [held_a, held_b] = [a, b].map(|name| self.buffers.remove(&name));
        self.buffers.extend(held_a.map(|buffer| (b, buffer)));
        self.buffers.extend(held_b.map(|buffer| (a, buffer)));
    }

    /// Appends a pass to `encoder`, with its times where they are measured, and reports it.
    fn dispatch(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static Pass,
        size: Size,
        job: u64,
        stage: Stage,
    ) {
        // Buffers of recorded stages may be changed between passes, so their shaders are checked.
        let checks = match self.recording {
            Recording::Stages => Checks::Checked,
            Recording::Nothing | Recording::Passes => self.gpu.checks,
        };
        let kernel = self.gpu.kernels.get(&self.gpu.device, pass, checks);

        let group = self.bind(&kernel.layout, pass, job);
        // `next` gives the timestamps behind those of the pending passes. The report adds this pass to them, so that it
        // comes second.
        let first_time = self.times.as_mut().and_then(Times::next);
        self.report(pass, size, stage);
        let timestamp_writes = first_time.and_then(|first| {
            self.times
                .as_ref()
                .map(|times| wgpu::ComputePassTimestampWrites {
                    query_set: &times.queries,
                    beginning_of_pass_write_index: Some(first),
                    end_of_pass_write_index: Some(first + 1),
                })
        });

        let mut encoded = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(pass.name),
            timestamp_writes,
        });
        encoded.set_pipeline(&kernel.pipeline);
        encoded.set_bind_group(0, &group, &[]);

        if let Some([x, y, z]) = workgroups(size) {
            encoded.dispatch_workgroups(x, y, z);
        } else if let Size::Indirect(argument) = size
            && let Some((buffer, _)) = self.buffers.get(&Name::Arguments)
        {
            // The arguments of a dispatch are three words, 12 bytes.
            encoded.dispatch_workgroups_indirect(buffer, 12 * u64::from(argument));
        }
    }

    /// Returns the buffers of a pass bound in the order of its bindings, with its own job.
    fn bind(&self, layout: &wgpu::BindGroupLayout, pass: &Pass, job: u64) -> wgpu::BindGroup {
        let entries: Vec<wgpu::BindGroupEntry<'_>> = pass
            .bindings
            .iter()
            .zip(0..)
            .filter_map(|(binding, number)| {
                let resource = if binding.name == Name::Job {
                    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                        buffer: &self.jobs,
                        offset: job * JOB_STRIDE,
                        size: std::num::NonZeroU64::new(size_of::<Job>() as u64),
                    })
                } else {
                    // A missing buffer leaves its binding empty. The device then rejects the pass, and the next check
                    // of the device fails.
                    self.buffers.get(&binding.name)?.0.as_entire_binding()
                };
                Some(wgpu::BindGroupEntry {
                    binding: number,
                    resource,
                })
            })
            .collect();

        self.gpu
            .device
            .create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(pass.name),
                layout,
                entries: &entries,
            })
    }

    /// Adds the report of a pass, if passes are reported.
    fn report(&mut self, pass: &'static Pass, size: Size, stage: Stage) {
        // Lengths are read before the reports are borrowed. That of a job is 0, as the jobs of all passes share a
        // buffer of their own.
        let bindings = pass
            .bindings
            .iter()
            .map(|binding| (binding.name, binding.access, self.length(binding.name)))
            .collect();
        let Some(reports) = &mut self.reports else {
            return;
        };

        let known_workgroups = workgroups(size);
        // Times are read back later, for many passes at once.
        if let Some(times) = &mut self.times {
            times.pending.push(reports.len());
        }

        reports.push(PassReport {
            stage,
            name: pass.name,
            indirect: known_workgroups.is_none(),
            workgroups: known_workgroups,
            invocations: known_workgroups.map(invocations),
            bindings,
            seconds: None,
        });
    }

    /// Fills in the number of workgroups of the last pass, whose command is `command`, if the device computed it. The
    /// arguments of a dispatch are three words.
    pub(crate) async fn read_workgroups(&mut self, command: &Command) -> Result<(), GpuError> {
        let Command::Dispatch {
            size: Size::Indirect(argument),
            ..
        } = command
        else {
            return Ok(());
        };

        let first = 3 * u64::from(*argument);
        let words = self.words(Name::Arguments, first..first + 3).await?;

        let reports = self.reports.as_mut();
        if let Some(report) = reports.and_then(|reports| reports.last_mut())
            && let [x, y, z] = words[..]
        {
            report.workgroups = Some([x, y, z]);
            report.invocations = Some(invocations([x, y, z]));
        }
        Ok(())
    }

    /// Reads the times of the passes since the last reading into their reports.
    pub(crate) async fn read_times(&mut self) -> Result<(), GpuError> {
        let Some(times) = &mut self.times else {
            return Ok(());
        };

        let pending = std::mem::take(&mut times.pending);
        // Passes past the last timestamp have no time.
        let count = (2 * pending.len() as u32).min(MAX_TIMESTAMPS);
        if count == 0 {
            return Ok(());
        }

        let mut encoder = self.gpu.encoder();
        encoder.resolve_query_set(&times.queries, 0..count, &times.resolved, 0);
        self.gpu.queue.submit([encoder.finish()]);
        let bytes = self
            .gpu
            .read(&times.resolved, 0..8 * u64::from(count))
            .await?;
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes);

        if let Some(reports) = &mut self.reports {
            for (index, pair) in pending.iter().zip(ticks.chunks_exact(2)) {
                let elapsed = pair[1].saturating_sub(pair[0]) as f64;
                // A device that does not measure leaves both at 0.
                reports[*index].seconds = (pair[1] > 0).then_some(elapsed * times.period_ns * 1e-9);
            }
        }
        Ok(())
    }
}

impl Times {
    /// Makes the queries of timestamps and the buffer that takes their results.
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let queries = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("times"),
            ty: wgpu::QueryType::Timestamp,
            count: MAX_TIMESTAMPS,
        });

        // A timestamp takes 8 bytes.
        let resolved = gpu.buffer(
            "times",
            8 * u64::from(MAX_TIMESTAMPS),
            wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
        )?;

        Ok(Self {
            queries,
            resolved,
            pending: Vec::new(),
            period_ns: f64::from(gpu.queue.get_timestamp_period()),
        })
    }

    /// Returns the index of the next pass' two timestamps, or `None` if there is no more room.
    fn next(&mut self) -> Option<u32> {
        let first = 2 * self.pending.len() as u32;
        (first + 2 <= MAX_TIMESTAMPS).then_some(first)
    }
}

/// Returns how many invocations some workgroups have.
fn invocations(workgroups: [u32; 3]) -> u64 {
    workgroups.map(u64::from).iter().product::<u64>() * u64::from(WORKGROUP)
}

/// Returns the workgroups of a dispatch, or `None` if the device computes them.
fn workgroups(size: Size) -> Option<[u32; 3]> {
    let groups = match size {
        Size::Invocations(count) => count.div_ceil(WORKGROUP.into()),
        Size::Workgroups(count) => count,
        Size::Indirect(_) => return None,
    };

    // Rows of workgroups, since one axis holds 65,535 of them where WebGPU guarantees no more.
    let columns = groups.min(GROUP_COLUMNS.into());
    let rows = groups.div_ceil(GROUP_COLUMNS.into());
    Some([columns as u32, rows as u32, 1])
}
