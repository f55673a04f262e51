//! Several signals over the same samples, laid out `[channel][time]`.

/// A table of `channels` signals of `samples` values each; every signal is one contiguous run.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::channels::Channels;
///
/// // Two joints over three samples; every signal is one slice.
/// let mut q = Channels::from_vectors(&[vec![0.0, 0.1, 0.2], vec![1.0, 1.0, 1.0]]);
/// assert_eq!((q.channels(), q.samples()), (2, 3));
/// assert_eq!((q.channel(0), q.at(2)), (&[0.0, 0.1, 0.2][..], vec![0.2, 1.0]));
///
/// q.channel_mut(1)[0] = 0.5;
/// assert_eq!(q.map(|_, signal| vec![signal.iter().sum()]).as_slice(), [0.1 + 0.2, 2.5]);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Channels {
    channels: usize,
    samples: usize,
    data: Vec<f64>,
}

impl Channels {
    /// All zeros.
    pub fn zeros(channels: usize, samples: usize) -> Self {
        Channels { channels, samples, data: vec![0.0; channels * samples] }
    }

    /// From one vector per channel.
    ///
    /// # Panics
    /// If the vectors differ in length.
    pub fn from_vectors(vectors: &[Vec<f64>]) -> Self {
        let samples = vectors.first().map_or(0, Vec::len);
        assert!(vectors.iter().all(|v| v.len() == samples), "channels differ in length");
        Channels { channels: vectors.len(), samples, data: vectors.concat() }
    }

    /// From a closure that appends each signal, by its index, to those before it.
    ///
    /// # Panics
    /// If the signals differ in length.
    pub fn appended(channels: usize, samples: usize, mut append: impl FnMut(usize, &mut Vec<f64>)) -> Self {
        let mut data = Vec::with_capacity(channels * samples);
        for index in 0..channels {
            append(index, &mut data);
            assert_eq!(data.len(), (index + 1) * samples, "channels differ in length");
        }
        Channels { channels, samples, data }
    }

    /// Number of channels.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Samples in each channel.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// One signal.
    pub fn channel(&self, index: usize) -> &[f64] {
        &self.data[index * self.samples..][..self.samples]
    }

    /// One signal, to write.
    pub fn channel_mut(&mut self, index: usize) -> &mut [f64] {
        &mut self.data[index * self.samples..][..self.samples]
    }

    /// All signals in order.
    pub fn iter(&self) -> impl Iterator<Item = &[f64]> + Clone {
        (0..self.channels).map(|index| self.channel(index))
    }

    /// The whole table, `[channel][time]`.
    pub fn as_slice(&self) -> &[f64] {
        &self.data
    }

    /// The whole table, to write.
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        &mut self.data
    }

    /// The numbers of the whole table, `[channel][time]`.
    pub fn into_vec(self) -> Vec<f64> {
        self.data
    }

    /// Adds a signal behind the others.
    ///
    /// # Panics
    /// If it has another number of samples.
    pub fn push(&mut self, signal: &[f64]) {
        assert!(self.channels == 0 || signal.len() == self.samples, "channels differ in length");
        self.samples = signal.len();
        self.channels += 1;
        self.data.reserve_exact(signal.len());
        self.data.extend_from_slice(signal);
    }

    /// The values of all channels at one sample.
    pub fn at(&self, sample: usize) -> Vec<f64> {
        self.iter().map(|signal| signal[sample]).collect()
    }

    /// Writes the values of all channels at one sample.
    pub fn set(&mut self, sample: usize, values: &[f64]) {
        for (index, &value) in values.iter().enumerate() {
            self.channel_mut(index)[sample] = value;
        }
    }

    /// Takes a table of the same size off this one.
    pub(crate) fn subtract(&mut self, other: &Channels) {
        self.data.iter_mut().zip(&other.data).for_each(|(value, other)| *value -= other);
    }

    /// A table of what `convert` makes of every signal.
    pub fn map(&self, mut convert: impl FnMut(usize, &[f64]) -> Vec<f64>) -> Self {
        let mut made = Channels::default();
        for (index, signal) in self.iter().enumerate() {
            let signal = convert(index, signal);
            if index == 0 {
                made.data.reserve_exact(self.channels * signal.len());
            }
            made.push(&signal);
        }
        made
    }
}
