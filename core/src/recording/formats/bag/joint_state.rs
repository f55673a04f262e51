//! sensor_msgs/JointState in CDR, the encoding in which ROS 2 sends its messages.
//!
//! Four bytes give the byte order; alignment counts from behind them. A sequence is its length and then its elements; an
//! empty one takes no padding. (OMG, Common Data Representation, version 1: DDSI-RTPS, section 10.)

/// A message as it was sent.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct JointState {
    /// Time of the header, ns since 1970; 0 where nobody set it.
    pub stamp_ns: i64,
    /// Names of the joints.
    pub names: Vec<String>,
    /// Positions, in the order of the names; may be empty, as the two below.
    pub position: Vec<f64>,
    /// Velocities.
    pub velocity: Vec<f64>,
    /// Torques or forces.
    pub effort: Vec<f64>,
}

impl JointState {
    /// Reads a message.
    ///
    /// # Errors
    /// What is wrong with the bytes, as a phrase.
    pub(super) fn decode(bytes: &[u8]) -> Result<JointState, String> {
        let little = match bytes {
            [0, 1, _, _, ..] => true,
            [0, 0, _, _, ..] => false,
            _ => return Err("it does not begin as CDR does".to_owned()),
        };
        let mut reader = Reader { body: &bytes[4..], at: 0, little };
        let seconds = i64::from(reader.u32()? as i32);
        let stamp_ns = seconds * 1_000_000_000 + i64::from(reader.u32()?);
        reader.string()?;
        let count = reader.count(4)?;
        let names = (0..count).map(|_| reader.string()).collect::<Result<Vec<_>, _>>()?;
        let state = JointState {
            stamp_ns,
            names,
            position: reader.numbers()?,
            velocity: reader.numbers()?,
            effort: reader.numbers()?,
        };
        let joints = state.names.len();
        for (quantity, values) in
            [("positions", &state.position), ("velocities", &state.velocity), ("efforts", &state.effort)]
        {
            if !values.is_empty() && values.len() != joints {
                return Err(format!("it has {} {quantity} for {joints} joints", values.len()));
            }
        }
        Ok(state)
    }
}

impl JointState {
    /// The message as it is sent, in little-endian order, with an empty frame.
    pub(super) fn encode(&self) -> Vec<u8> {
        let mut bytes = vec![0, 1, 0, 0];
        let word = |bytes: &mut Vec<u8>, value: u32| {
            align(bytes, 4);
            bytes.extend(value.to_le_bytes());
        };
        let text = |bytes: &mut Vec<u8>, text: &str| {
            word(bytes, text.len() as u32 + 1);
            bytes.extend(text.as_bytes());
            bytes.push(0);
        };
        word(&mut bytes, self.stamp_ns.div_euclid(1_000_000_000) as i32 as u32);
        word(&mut bytes, self.stamp_ns.rem_euclid(1_000_000_000) as u32);
        text(&mut bytes, "");
        word(&mut bytes, self.names.len() as u32);
        self.names.iter().for_each(|name| text(&mut bytes, name));
        for values in [&self.position, &self.velocity, &self.effort] {
            word(&mut bytes, values.len() as u32);
            for value in values {
                align(&mut bytes, 8);
                bytes.extend(value.to_le_bytes());
            }
        }
        bytes
    }
}

/// Fills up to a multiple of `size`, counted from behind the four bytes that give the byte order.
fn align(bytes: &mut Vec<u8>, size: usize) {
    bytes.resize(4 + (bytes.len() - 4).next_multiple_of(size), 0);
}

/// Walks through the bytes behind the four that give the byte order.
struct Reader<'a> {
    body: &'a [u8],
    at: usize,
    little: bool,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let start = self.at.next_multiple_of(N);
        let bytes = self.body.get(start..start + N).ok_or("it is cut off")?;
        self.at = start + N;
        let mut out = [0; N];
        out.copy_from_slice(bytes);
        Ok(out)
    }

    fn u32(&mut self) -> Result<u32, String> {
        let bytes = self.take()?;
        Ok(if self.little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    fn f64(&mut self) -> Result<f64, String> {
        let bytes = self.take()?;
        Ok(if self.little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) })
    }

    /// Length of a sequence whose elements take `size` bytes or more each.
    fn count(&mut self, size: usize) -> Result<usize, String> {
        let count = self.u32()? as usize;
        if count > (self.body.len() - self.at) / size {
            return Err("it is cut off".to_owned());
        }
        Ok(count)
    }

    fn string(&mut self) -> Result<String, String> {
        let count = self.count(1)?;
        let bytes = &self.body[self.at..self.at + count];
        self.at += count;
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        Ok(String::from_utf8_lossy(text).into_owned())
    }

    fn numbers(&mut self) -> Result<Vec<f64>, String> {
        let count = self.count(8)?;
        (0..count).map(|_| self.f64()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Laid out by hand: stamp 1 s 2 ns, frame "b", joints "a", "bcd", positions 1 and -2, no velocity, efforts 0.5 and 4.
    fn message(little: bool) -> Vec<u8> {
        let mut bytes = vec![0, u8::from(little), 0, 0];
        let word = |value: u32| if little { value.to_le_bytes() } else { value.to_be_bytes() };
        let number = |value: f64| if little { value.to_le_bytes() } else { value.to_be_bytes() };
        let mut push = |part: &[u8]| bytes.extend_from_slice(part);
        push(&word(1));
        push(&word(2));
        push(&word(2));
        push(b"b\0\0\0");
        push(&word(2));
        push(&word(2));
        push(b"a\0\0\0");
        push(&word(4));
        push(b"bcd\0");
        // 36 bytes so far: four of padding bring the numbers to a multiple of eight behind their count.
        push(&word(2));
        push(&number(1.0));
        push(&number(-2.0));
        push(&word(0));
        push(&word(2));
        push(&number(0.5));
        push(&number(4.0));
        bytes
    }

    #[test]
    fn both_byte_orders() {
        for little in [true, false] {
            let state = JointState::decode(&message(little)).unwrap();
            assert_eq!(state.stamp_ns, 1_000_000_002);
            assert_eq!(state.names, ["a", "bcd"]);
            assert_eq!(state.position, [1.0, -2.0]);
            assert_eq!((state.velocity.len(), state.effort), (0, vec![0.5, 4.0]));
        }
    }

    #[test]
    fn every_cut_is_refused() {
        let whole = message(true);
        for length in 0..whole.len() {
            assert!(JointState::decode(&whole[..length]).is_err(), "{length} bytes");
        }
    }

    #[test]
    fn lengths_must_agree() {
        let mut bytes = message(true);
        let at = bytes.len() - 20;
        bytes[at..at + 4].copy_from_slice(&1u32.to_le_bytes());
        assert_eq!(JointState::decode(&bytes).unwrap_err(), "it has 1 efforts for 2 joints");
    }

    proptest! {
        #[test]
        fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = JointState::decode(&bytes);
            let _ = JointState::decode(&[&[0, 1, 0, 0], bytes.as_slice()].concat());
        }
    }

    proptest! {
        #[test]
        fn what_is_encoded_is_decoded(
            stamp_ns in 0..2_000_000_000_000_000_000i64,
            names in prop::collection::vec("[a-zäß_]{0,9}", 0..5),
            (position, velocity, effort) in (any::<bool>(), any::<bool>(), any::<bool>()),
            seed in any::<u64>(),
        ) {
            let values = |there: bool, shift: u64| -> Vec<f64> {
                let bits = |k: usize| f64::from_bits((seed ^ (shift << 40)).wrapping_mul(k as u64 + 3) >> 2);
                if there { (0..names.len()).map(bits).collect() } else { Vec::new() }
            };
            let (position, velocity, effort) = (values(position, 1), values(velocity, 2), values(effort, 3));
            let state = JointState { stamp_ns, names: names.clone(), position, velocity, effort };
            prop_assert_eq!(JointState::decode(&state.encode()), Ok(state));
        }
    }
}
