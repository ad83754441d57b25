//! Built-in functions that combine the components of vectors.

use naga::ScalarKind;

use super::Lowering;
use crate::code::Words;
use crate::error::LowerError;
use crate::instruction::Op;

impl Lowering<'_, '_> {
    pub(super) fn dot(
        &mut self,
        kind: ScalarKind,
        a: &Words,
        b: &Words,
    ) -> Result<u32, LowerError> {
        if kind == ScalarKind::Float {
            return self.sum_of_products(a.iter().zip(b.iter()));
        }
        let mut sum = self.two(Op::MulW, a.at(0), b.at(0))?;
        for (a, b) in a.iter().zip(b.iter()).skip(1) {
            let product = self.two(Op::MulW, a, b)?;
            sum = self.two(Op::AddW, sum, product)?;
        }
        Ok(sum)
    }

    pub(super) fn length(&mut self, v: &Words) -> Result<u32, LowerError> {
        if v.len() == 1 {
            return self.one(Op::AbsF, v.at(0));
        }
        let squared = self.dot(ScalarKind::Float, v, v)?;
        self.one(Op::SqrtF, squared)
    }

    pub(super) fn distance(&mut self, a: &Words, b: &Words) -> Result<u32, LowerError> {
        let difference = self.zip(Op::SubF, a, b)?;
        self.length(&difference)
    }

    pub(super) fn normalize(&mut self, v: &Words) -> Result<Words, LowerError> {
        let length = self.length(v)?;
        self.zip(Op::DivF, v, &Words::one(length))
    }

    pub(super) fn cross(&mut self, a: &Words, b: &Words) -> Result<Words, LowerError> {
        [(1, 2), (2, 0), (0, 1)]
            .into_iter()
            .map(|(i, j)| {
                let first = self.two(Op::MulF, a.at(i), b.at(j))?;
                let second = self.two(Op::MulF, a.at(j), b.at(i))?;
                self.two(Op::SubF, first, second)
            })
            .collect()
    }

    pub(super) fn outer(&mut self, a: &Words, b: &Words) -> Result<Words, LowerError> {
        b.iter()
            .flat_map(|b| a.iter().map(move |a| (a, b)))
            .map(|(a, b)| self.two(Op::MulF, a, b))
            .collect()
    }

    /// `v`, or its opposite unless `incident` goes against `reference`.
    pub(super) fn face_forward(
        &mut self,
        v: &Words,
        incident: &Words,
        reference: &Words,
    ) -> Result<Words, LowerError> {
        let dot = self.dot(ScalarKind::Float, incident, reference)?;
        let zero = self.float(0.0)?;
        let against = self.two(Op::LtF, dot, zero)?;
        let opposite = self.map(Op::NegF, v)?;
        self.select(&Words::one(against), v, &opposite)
    }

    pub(super) fn reflect(
        &mut self,
        incident: &Words,
        normal: &Words,
    ) -> Result<Words, LowerError> {
        let dot = self.dot(ScalarKind::Float, normal, incident)?;
        let two = self.float(2.0)?;
        let twice = self.two(Op::MulF, two, dot)?;
        let along = self.zip(Op::MulF, &Words::one(twice), normal)?;
        self.zip(Op::SubF, incident, &along)
    }

    /// Zero where the angle is that of total reflection.
    pub(super) fn refract(
        &mut self,
        incident: &Words,
        normal: &Words,
        ratio: u32,
    ) -> Result<Words, LowerError> {
        let dot = self.dot(ScalarKind::Float, normal, incident)?;
        let (zero, one) = (self.float(0.0)?, self.float(1.0)?);
        let squared = self.two(Op::MulF, dot, dot)?;
        let sine = self.two(Op::SubF, one, squared)?;
        let ratio_squared = self.two(Op::MulF, ratio, ratio)?;
        let product = self.two(Op::MulF, ratio_squared, sine)?;
        let k = self.two(Op::SubF, one, product)?;
        let root = self.one(Op::SqrtF, k)?;
        let factor = self.three(Op::MulAddF, ratio, dot, root)?;
        let kept = self.zip(Op::MulF, &Words::one(ratio), incident)?;
        let along = self.zip(Op::MulF, &Words::one(factor), normal)?;
        let refracted = self.zip(Op::SubF, &kept, &along)?;
        let is_total = self.two(Op::LtF, k, zero)?;
        let nothing = Words::Repeat {
            register: zero,
            len: incident.len(),
        };
        self.select(&Words::one(is_total), &nothing, &refracted)
    }
}
